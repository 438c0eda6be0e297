"""Figures of contacts, histories, studies and tables.

Every function returns a matplotlib `Figure` that belongs to no window and no global state. Only
`save_all` and `animate` write files.
"""

from tractive_sam.lazy_names import attach_names, with_renamed

# Names, listed in __init__.pyi, are looked up when first used.
__getattr__, __dir__, __all__ = attach_names(__name__, __file__)
__getattr__ = with_renamed(
    __name__,
    __getattr__,
    {
        "Drawn": "ContactView",
        "chosen": "select_evenly",
        "compared": "compare",
        "continued": "extend_outwards",
        "figures_of": "list_figures",
        "von_mises": "von_mises_section",
        "wear_profiles": "wear_depth_profiles",
    },
)
