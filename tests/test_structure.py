"""The structure of the package in numbers, each with a limit that only falls.

The numbers show early that a change makes the code harder to read: imports that build on each
other, files and functions that were split so that a reader must look up what belongs together,
functions and modules that do several things, constants that belong to a record. If one exceeds its
limit, improve the code; if a number has fallen, lower its limit. Do not evade them, and change a
limit that makes the code worse.

There is no limit on the length of the package, and none on modules of less than 500 lines or
functions of less than 60: such limits split 426 modules of 77 lines, whose import statements were a
ninth of the code.
"""

import ast
from collections import Counter
from functools import cache
from pathlib import Path
from statistics import median

import pytest

import tractive_sam

LIMITS = {
    "modules on the longest chain of imports": 9,
    "modules that import each other, in any way": 0,
    "modules with TYPE_CHECKING": 3,
    "modules over 500 code lines": 0,
    "functions over 60 code lines": 0,
    "import lines, per cent of code lines": 8.1,
    "functions of at most 3 statements with one use": 197,  # conditions of columns, hooks
    "module constants": 292,  # 40 of them are published values and sources in `validation`
    "public names": 168,
}

SMALLEST = {"code lines of the median module": 200}
"""Numbers that only rise."""

PACKAGE = Path(tractive_sam.__file__).parent


class Module:
    """A module: its statements, all nodes of their syntax trees, and its code lines."""

    def __init__(self, path):
        parts = (PACKAGE.name, *path.relative_to(PACKAGE).with_suffix("").parts)
        self.name = ".".join(parts).removesuffix(".__init__")
        self.is_package = path.stem == "__init__"
        source = path.read_text("utf-8")
        self.statements = ast.parse(source).body
        self.nodes = [node for statement in self.statements for node in ast.walk(statement)]
        self.code_lines = find_code_lines(source, self.nodes)

    def absolute_name(self, node):
        """Return the name of the module from which an import statement takes names."""
        if node.level == 0:
            return node.module
        parts = self.name.split(".")
        parts = parts[: len(parts) - node.level + self.is_package]
        return ".".join([*parts, node.module] if node.module else parts)

    def functions(self):
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
        return [node for node in self.nodes if isinstance(node, kinds)]

    def count_code_lines(self, node):
        return len(self.code_lines.intersection(range(node.lineno, node.end_lineno + 1)))

    def constants(self):
        """Names in capitals that the module assigns outside of functions and classes."""
        assignments = [n for n in self.statements if isinstance(n, ast.Assign | ast.AnnAssign)]
        targets = [n.targets[0] if isinstance(n, ast.Assign) else n.target for n in assignments]
        return [n.id for n in targets if isinstance(n, ast.Name) and n.id.isupper()]

    def has_type_checking(self):
        return any(is_type_checking(node) for node in self.nodes)


def find_code_lines(source, nodes):
    """Return the numbers of all lines but empty ones, comments and docstrings."""
    text = {
        line
        for node in nodes
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        if isinstance(node.value.value, str)
        for line in range(node.lineno, node.end_lineno + 1)
    }
    lines = enumerate(map(str.strip, source.splitlines()), start=1)
    return {number for number, line in lines if line and not line.startswith("#")} - text


def is_type_checking(node):
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def walk_executed(nodes):
    """Yield the statements that run when a module is imported."""
    for node in nodes:
        if is_type_checking(node):
            yield from walk_executed(node.orelse)
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node
            yield from walk_executed(ast.iter_child_nodes(node))


def imported_modules(module, nodes, names):
    """Return the `names`, other than the module, that import statements among `nodes` name."""
    found = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            source = module.absolute_name(node)
            members = {f"{source}.{alias.name}" for alias in node.names}
            found |= members & names | ({source} if members - names else set())
    return found & names - {module.name}


def read_modules():
    return {module.name: module for module in map(Module, sorted(PACKAGE.rglob("*.py")))}


def longest_chain(modules):
    """Return the number of modules on the longest chain of imports that run on import."""
    names = set(modules)

    @cache
    def chain_from(name):
        module = modules[name]
        imported = imported_modules(module, walk_executed(module.statements), names)
        return 1 + max(map(chain_from, imported), default=0)

    return max(map(chain_from, names))


def circular_modules(modules):
    """Return the modules that import themselves through others, also in functions and for types.

    An `__init__` only passes names on, and is left out.
    """
    names = {name for name, module in modules.items() if not module.is_package}
    imports = {name: imported_modules(modules[name], modules[name].nodes, names) for name in names}

    def reaches_itself(name):
        reached, new = set(), imports[name]
        while new:
            reached |= new
            new = set().union(*(imports[other] for other in new)) - reached
        return name in reached

    return sorted(filter(reaches_itself, names))


def count_import_lines(module):
    imports = [n for n in module.nodes if isinstance(n, ast.Import | ast.ImportFrom)]
    lines = {k for node in imports for k in range(node.lineno, node.end_lineno + 1)}
    return len(lines & module.code_lines)


def count_small_single_uses(modules):
    """Return the number of functions of at most 3 statements that one place uses."""
    nodes = [node for module in modules for node in module.nodes]
    uses = Counter(n.id for n in nodes if isinstance(n, ast.Name))
    uses.update(n.attr for n in nodes if isinstance(n, ast.Attribute))
    functions = [function for module in modules for function in module.functions()]
    definitions = Counter(function.name for function in functions)
    return sum(
        definitions[function.name] == uses[function.name] == 1
        and not function.name.startswith("__")
        for function in functions
        if count_statements(function) <= 3
    )


def count_statements(function):
    """Return the number of statements of a function, also nested ones, without its docstring."""
    nested = sum(isinstance(node, ast.stmt) for node in ast.walk(function))
    return nested - 1 - (ast.get_docstring(function) is not None)


@cache
def measure():
    modules = read_modules()
    lengths = [m.count_code_lines(node) for m in modules.values() for node in m.functions()]
    sizes = [len(module.code_lines) for module in modules.values()]
    imports = sum(map(count_import_lines, modules.values()))
    return {
        "modules on the longest chain of imports": longest_chain(modules),
        "modules that import each other, in any way": len(circular_modules(modules)),
        "modules with TYPE_CHECKING": sum(m.has_type_checking() for m in modules.values()),
        "modules over 500 code lines": sum(size > 500 for size in sizes),
        "functions over 60 code lines": sum(length > 60 for length in lengths),
        "import lines, per cent of code lines": 100.0 * imports / sum(sizes),
        "functions of at most 3 statements with one use": count_small_single_uses(modules.values()),
        "module constants": sum(len(module.constants()) for module in modules.values()),
        "public names": len(dir(tractive_sam)),
        "code lines of the median module": median(filter(None, sizes)),
    }


@pytest.mark.parametrize("quantity", LIMITS)
def test_structure_stays_within_its_limit(quantity):
    assert measure()[quantity] <= LIMITS[quantity]


@pytest.mark.parametrize("quantity", SMALLEST)
def test_structure_reaches_its_smallest_number(quantity):
    assert measure()[quantity] >= SMALLEST[quantity]
