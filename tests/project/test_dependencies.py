"""The workflow must know every module that a script uses, and no other."""

from __future__ import annotations

import ast
import json
import sys
from pathlib import Path

from dampbalance.project.dependencies import package_modules
from folders import ROOT
from processes import output_of

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


# Runs imports, given as [statements, package faces], one after the other, the package loaded anew each time and the
# libraries once. A face is empty: only what is asked for is loaded.
PROGRAM = """
import json, sys, types
for statements, faces in json.load(sys.stdin):
    for name in [name for name in sys.modules if name.partition('.')[0] == 'dampbalance']:
        del sys.modules[name]
    for name, folder in faces.items():
        face = types.ModuleType(name)
        face.__path__, face.__version__ = [folder], ''
        sys.modules[name] = face
    exec(statements, {})
    modules = [module for name, module in sys.modules.items() if name.startswith('dampbalance.')]
    print(json.dumps([m.__file__ for m in modules if getattr(m, '__file__', None)]))
"""


def test_nothing_that_python_loads_is_missing():
    """The files of the package that the imports of each script load, in a fresh Python, are among those listed."""
    told, listed = [], [package_modules(script, ROOT / "src") for script in SCRIPTS]
    for script, names in zip(SCRIPTS, listed, strict=True):
        tree = ast.parse(script.read_text(encoding="utf-8"))
        imports = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
        faces = {  # but for those that the script takes names from
            str(init.parent.relative_to(ROOT / "src")).replace("/", "."): str(init.parent)
            for init in (ROOT / "src/dampbalance").rglob("__init__.py")
            if str(init.relative_to(ROOT / "src")) not in names
        }
        told.append(["\n".join(map(ast.unparse, imports)), faces])
    lines = output_of(sys.executable, "-c", PROGRAM, given=json.dumps(told)).splitlines()
    for script, names, line in zip(SCRIPTS, listed, lines, strict=True):
        loaded = {str(Path(file).relative_to(ROOT / "src")) for file in json.loads(line)}
        assert loaded, f"{script} makes no use of the package"
        assert loaded <= set(names), script
