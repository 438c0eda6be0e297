"""Contents of a bundle that PyInstaller cannot find in the import statements."""

from PyInstaller.utils.hooks import collect_data_files, collect_submodules, copy_metadata

# Names of packages are looked up when first used (`tractive_sam.lazy_names`).
hiddenimports = collect_submodules("tractive_sam")
datas = [
    *collect_data_files("tractive_sam", excludes=["**/__pycache__"]),
    *copy_metadata("tractive-sam"),
]
# Compiled kernels are stored with a hash of their sources (`tractive_sam.kernels.compiled`).
module_collection_mode = {"tractive_sam.kernels": "pyz+py"}
