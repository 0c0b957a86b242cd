"""The house's rooms: imports point down only."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

# Room → the rooms that it may import, besides itself. `jaxocean/` stands for its level-0 files.
BASE = {"jaxocean._types", "jaxocean._constants", "jaxocean._numerics", "jaxocean._elementary"}
PHYSICS = {"jaxocean.wind", "jaxocean.spectra"}
SHORE = {"jaxocean.optics", "jaxocean.imagery"}
TO_SURFACE = PHYSICS | {"jaxocean.surface"}
TO_FILTERING = TO_SURFACE | {"jaxocean.filtering"}
TO_WHITECAPS = TO_FILTERING | {"jaxocean.whitecaps"}
TO_OCEAN = TO_WHITECAPS | SHORE | {"jaxocean.ocean", "jaxocean._ocean"}
TO_RENDER = TO_OCEAN | {"jaxocean.render"}
MAY_IMPORT = {
    "jaxocean._types": set(),
    "jaxocean._constants": {"jaxocean._types"},
    "jaxocean._numerics": {"jaxocean._types", "jaxocean._constants"},
    "jaxocean._elementary": set(),
    "jaxocean.wind": BASE,
    "jaxocean.spectra": BASE | {"jaxocean.wind"},
    "jaxocean.optics": BASE,
    "jaxocean.imagery": BASE,
    "jaxocean.surface": BASE | PHYSICS,
    "jaxocean.filtering": BASE | TO_SURFACE,
    "jaxocean.whitecaps": BASE | TO_FILTERING,
    "jaxocean.ocean": BASE | TO_WHITECAPS | SHORE,
    "jaxocean._ocean": BASE | TO_WHITECAPS | SHORE,
    "jaxocean.render": BASE | TO_OCEAN,
    "jaxocean.io": BASE | TO_RENDER,
    "fitting": {"jaxocean"} | BASE | TO_RENDER,
    "experiments": {"jaxocean", "jaxocean.io", "fitting"} | BASE | TO_RENDER,
    "benchmarks": {"jaxocean", "jaxocean.io", "fitting", "experiments"} | BASE | TO_RENDER,
}
ROOMS = ("jaxocean", "fitting", "experiments", "benchmarks")
FILES = sorted(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))

# Slow to import, and of no use to somebody who only computes.
NEVER_IN_THE_LIBRARY = {
    "matplotlib",
    "xarray",
    "wavespectra",
    "pandas",
    "dask",
    "scipy",
    "typer",
    "rich",
    "omegaconf",
}
NEVER_IN_THE_LIBRARY |= {"pydantic", "netCDF4", "yaml", "colour"}


def module_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def room_of(module: str) -> str:
    """jaxocean.spectra._jonswap → jaxocean.spectra; fitting.solvers → fitting."""
    parts = module.split(".")
    return ".".join(parts[:2]) if parts[0] == "jaxocean" else parts[0]


def imports_of(source: str, module: str, *, package: bool) -> list[tuple[str, bool]]:
    """Absolute names of what is imported (`a.b` for `from a import b`), and whether it happens at import."""
    tree = ast.parse(source)
    later = {
        inner
        for outer in ast.walk(tree)
        if isinstance(outer, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) or _for_types_only(outer)
        for inner in ast.walk(outer)
    }
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(alias.name, node not in later) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            anchor = module.split(".")
            if node.level:
                anchor = anchor[: len(anchor) - node.level + package]
                start = ".".join([*anchor, *([node.module] if node.module else [])])
            else:
                start = node.module or ""
            found += [(f"{start}.{alias.name}", node not in later) for alias in node.names]
    return found


def _for_types_only(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def imports_of_file(path: Path) -> list[tuple[str, bool]]:
    return imports_of(path.read_text(), module_of(path), package=path.name == "__init__.py")


def forbidden(module: str, imported: str) -> bool:
    """Whether a module of ours imports a room that it must not see."""
    home, target = room_of(module), room_of(imported)
    if imported.split(".")[0] not in ROOMS or home == target:
        return False
    if home == "jaxocean":
        # The catalogue itself gathers all rooms but those that read files or draw.
        return target.split(".")[0] != "jaxocean"
    if home not in MAY_IMPORT:
        return True
    allowed = MAY_IMPORT[home]
    # `from jaxocean import x` or `import jaxocean` of a name that is no room means the whole library.
    if target.startswith("jaxocean") and target not in MAY_IMPORT:
        return "jaxocean" not in allowed
    return target not in allowed


def test_imports_point_down_only():
    wrong = [
        f"{module_of(path)} imports {name}"
        for path in FILES
        for name, _ in imports_of_file(path)
        if forbidden(module_of(path), name)
    ]
    assert not wrong, wrong


def test_every_room_stands_in_the_table():
    rooms = {room_of(module_of(path)) for path in FILES} - {"jaxocean"}
    assert rooms <= set(MAY_IMPORT)


@pytest.mark.parametrize(
    "path", [p for p in FILES if p.parts[len(ROOT.parts)] in ("jaxocean", "fitting")], ids=module_of
)
def test_the_library_is_light_to_import(path):
    wrong = [
        name for name, now in imports_of_file(path) if now and name.split(".")[0] in NEVER_IN_THE_LIBRARY
    ]
    assert not wrong, f"{module_of(path)} imports {wrong} when it is imported"


def test_only_experiments_reads_configs():
    readers = [module_of(p) for p in FILES if '"configs"' in p.read_text()]
    assert readers
    assert all(room_of(reader) == "experiments" for reader in readers), readers


def test_catalogues_hold_no_logic():
    for path in FILES:
        if path.name != "__init__.py":
            continue
        for node in ast.parse(path.read_text()).body:
            docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            constant = isinstance(node, ast.Assign | ast.AnnAssign)
            assert docstring or constant or isinstance(node, ast.Import | ast.ImportFrom), (
                f"{path}: {ast.unparse(node)}"
            )


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("jaxocean.wind._wind", "from ..spectra import Elfouhaily"),
        ("jaxocean.spectra._x", "from jaxocean.surface import Cascade"),
        ("jaxocean.optics._x", "from .. import spectra"),
        ("jaxocean.surface._x", "def f():\n    from ..whitecaps import jacobian"),
        ("fitting._x", "from jaxocean.io import read_spectrum"),
        ("fitting._x", "from jaxocean import io"),
        ("fitting._x", "import experiments"),
        ("jaxocean._numerics", "from .wind import Wind"),
    ],
)
def test_the_check_itself_sees_an_import_that_points_up(module, source):
    assert any(forbidden(module, name) for name, _ in imports_of(source, module, package=False))
