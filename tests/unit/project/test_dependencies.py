"""The workflow must know every module that a script uses, and no other."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from dampbalance.project.dependencies import package_modules

ROOT = Path(__file__).parents[3]
SCRIPTS = sorted((ROOT / "workflow/scripts").rglob("*.py"))


def test_imports_are_followed_through_modules_and_subpackages(tmp_path):
    package = tmp_path / "src/pkg"
    (package / "sub").mkdir(parents=True)
    (package / "__init__.py").write_text("from .unused import x\n")
    (package / "a.py").write_text("from .b import c\n")
    (package / "b.py").write_text("import os\nfrom . import d\n")
    (package / "d.py").write_text("c = 1\n")
    (package / "unused.py").write_text("x = 1\n")
    (package / "sub/__init__.py").write_text("from .deep import y\n")
    (package / "sub/deep.py").write_text("from ..d import c\ny = 2\n")
    script = tmp_path / "script.py"
    script.write_text("from pkg.a import c\n")
    assert package_modules(script, tmp_path / "src") == ["pkg/a.py", "pkg/b.py", "pkg/d.py"]
    script.write_text("from pkg import sub\n")
    found = package_modules(script, tmp_path / "src")
    assert found == ["pkg/d.py", "pkg/sub/__init__.py", "pkg/sub/deep.py"]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_nothing_that_python_loads_is_missing(script):
    """Run the imports of a script in a fresh Python: what they load besides the package's face is what we list."""
    tree = ast.parse(script.read_text(encoding="utf-8"))
    imports = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    listed = set(package_modules(script, ROOT / "src"))
    # Empty package faces, but for those that the script takes names from: only what is asked for is loaded.
    faces = {
        str(init.parent.relative_to(ROOT / "src")).replace("/", "."): str(init.parent)
        for init in (ROOT / "src/dampbalance").rglob("__init__.py")
        if str(init.relative_to(ROOT / "src")) not in listed
    }
    code = "\n".join(
        [
            "import sys, types",
            f"for name, folder in {faces!r}.items():",
            "    face = types.ModuleType(name)",
            "    face.__path__, face.__version__ = [folder], ''",
            "    sys.modules[name] = face",
            *(ast.unparse(node) for node in imports),
            "modules = [m for n, m in sys.modules.items() if n.startswith('dampbalance.')]",
            "print(*(m.__file__ for m in modules if getattr(m, '__file__', None)), sep='\\n')",
        ]
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {str(Path(line).relative_to(ROOT / "src")) for line in run.stdout.split()}
    assert loaded <= listed
