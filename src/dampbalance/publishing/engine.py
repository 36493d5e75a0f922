"""The kernels of the method as WebAssembly, with which the page computes: python -m dampbalance.publishing.engine.

Numba translates each kernel to LLVM's intermediate representation, without optimising it for this machine; llvmlite
optimises that for wasm32 and makes an object file, and the linker and C library of the package `ziglang` make a module
of it that imports nothing. `make engine` does this in an environment with ziglang in addition to the locked packages.
The module is kept with the sources, because few need to build it. A record next to it lists its sources, and a test
compares.

A kernel keeps Numba's calling convention, which `static/engine.js` follows: it takes the address of its result, the
address of what an exception says, and its arguments, an array as (0, 0, size, bytes of an item, address, shape,
strides), and returns a status, 0 unless Python would have raised an exception.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from .. import jit
from ..model import Parameters
from ..motion.integrals import measure
from ..motion.states import states_in_phases
from ..motion.steady import solve_closed, solve_otherwise

FOLDER = Path(__file__).parent / "page/static"
ENGINE, RECORD = "engine.wasm", "engine.json"
TOOLS = ("numba", "llvmlite", "ziglang")
_PACKAGE = Path(__file__).parents[1]

# Optimisation is for wasm32 and left to llvmlite.
_NUMBA = {"NUMBA_OPT": "0", "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}

# The part of Numba's runtime that kernels need: memory for arrays, all of which is free again at the next `reset`.
_RUNTIME = """
typedef struct { long long count; void *destructor, *its_argument, *data; long long size; } Info;
extern unsigned char __heap_base;
static unsigned long top;

void reset(void) { top = (unsigned long)&__heap_base; }

void *reserve(unsigned long size) {
    unsigned long start = (top + 15) & ~15ul, pages = __builtin_wasm_memory_size(0);
    top = start + size;
    if (top > pages << 16) __builtin_wasm_memory_grow(0, ((top + 65535) >> 16) - pages);
    return (void *)start;
}

Info *NRT_MemInfo_alloc_aligned(long long size, unsigned align) {
    Info *info = reserve(sizeof(Info));
    info->count = 1;
    info->data = reserve(size);
    return info;
}

void NRT_MemInfo_call_dtor(Info *info) {}
"""


def _kernels() -> list[tuple[Any, tuple[Any, ...]]]:
    """Return the kernels that the page calls, and the types of their arguments."""
    from numba import types as numba_types

    types: Any = numba_types
    real, whole = types.float64, types.int64
    par, line, table = types.NamedUniTuple(real, 7, Parameters), real[::1], real[:, ::1]
    return [
        (solve_closed, (par, table)),
        (solve_otherwise, (par, table, real)),
        (measure, (table, whole, real, par)),
        (states_in_phases, (line, table, real, par)),
    ]


def build(folder: Path) -> None:
    """Write the engine and the record of what it was made of to `folder`."""
    os.environ.update(_NUMBA)  # before Numba is imported
    modules = {"publishing/engine.py"}

    def compiled(function: Callable[..., object]) -> Any:
        import numba

        modules.add(Path(function.__code__.co_filename).relative_to(_PACKAGE).as_posix())
        return numba.njit(function)

    jit._compiled = compiled  # without the cache, whose entries may be optimised otherwise
    with tempfile.TemporaryDirectory() as scratch:
        names = _write_object(Path(scratch, "kernels.o"))
        Path(scratch, "runtime.c").write_text(_RUNTIME, encoding="utf-8")
        exported = (f"-Wl,--export={name}" for name in ("reset", "reserve", *names))
        compiler = (sys.executable, "-m", "ziglang", "cc", "-target", "wasm32-wasi", "-O2", "-s")
        linked = ("-mexec-model=reactor", "-Wl,--no-entry", "-Wl,-z,stack-size=262144", *exported)
        command = (*compiler, *linked, "kernels.o", "runtime.c", "-o", ENGINE)
        cached = os.environ | {"ZIG_GLOBAL_CACHE_DIR": str(Path(sys.prefix, "zig"))}
        subprocess.run(command, cwd=scratch, env=cached, check=True)
        engine = Path(scratch, ENGINE).read_bytes()
    (folder / ENGINE).write_bytes(engine)
    record = {
        "engine": hashlib.sha256(engine).hexdigest(),
        "python": ".".join(map(str, sys.version_info[:2])),
        "tools": {name: version(name) for name in TOOLS},
        "sources": source_digests(sorted(modules)),
    }
    (folder / RECORD).write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def source_digests(modules: list[str]) -> Mapping[str, str]:
    """Return the SHA-256 of modules of the package, named by their paths in it."""
    return {name: hashlib.sha256((_PACKAGE / name).read_bytes()).hexdigest() for name in modules}


def _write_object(path: Path) -> list[str]:
    """Compile the kernels to an object file; their names."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple("wasm32-unknown-unknown")
    machine = target.create_target_machine(cpu="generic", opt=2, reloc="static")
    whole, names = llvm.parse_assembly(""), []
    for kernel, types in _kernels():
        dispatcher = kernel.dispatcher
        dispatcher.compile(types)
        module = llvm.parse_assembly(_without_python(dispatcher.inspect_llvm(types)))
        names.append(kernel.py_func.__name__)
        module.get_function(dispatcher.overloads[types].fndesc.llvm_func_name).name = names[-1]
        for function in module.functions:
            if function.name.startswith(("_ZN7cpython", "cfunc.")):  # called from Python and C
                function.linkage = "internal"
        whole.link_in(module)
    whole.triple, whole.data_layout = machine.triple, str(machine.target_data)
    for value in (*whole.functions, *whole.global_variables):
        if not value.is_declaration and value.name not in names:
            value.linkage = "internal"
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(whole, builder)
    path.write_bytes(machine.emit_object(whole))
    return names


def _without_python(assembly: str) -> str:
    """Return a module without its target and the texts of exceptions, which hold addresses of this process."""
    assembly = re.sub(r"^target .*$", "", assembly, flags=re.MULTILINE)
    texts = r"^ *store ptr (?:@\.const\.picklebuf|%)\S*, ptr %excinfo, .*$"
    return re.sub(texts, "", assembly, flags=re.MULTILINE)


if __name__ == "__main__":
    build(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
