# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
"""Every kernel compiles for a GPU. That takes none: Warp brings NVIDIA's run-time compiler with it."""

from __future__ import annotations

import gc
import importlib
import sys
from pathlib import Path

import pytest
import warp as wp

import arcgym
from arcgym.sim.scope.aba_cuda_kernels import warp_kernel

ARCHITECTURE = 80
"""Compute capability 8.0, an A100: older than what the figures of the docs were measured on."""

ROOT = Path(arcgym.__file__).parents[1]
FILES = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "arcgym").rglob("*_kernels.py"))

pytestmark = pytest.mark.skipif(sys.platform == "darwin", reason="Warp for macOS has no CUDA compiler")


def compile_all(kernels: list[wp.Kernel], folder: Path) -> int:
    """Compile the modules of ``kernels`` to PTX and return how many files that made."""
    for module in {kernel.module for kernel in kernels}:
        wp.compile_aot_module(module, arch=ARCHITECTURE, module_dir=folder, use_ptx=True)
    return len(list(folder.glob("*.ptx")))


def test_a_mistake_in_code_for_a_gpu_alone_is_found(tmp_path: Path) -> None:
    @wp.func_native("#ifdef __CUDACC__\nno_such_function(value);\n#endif\n")
    def broken(value: float): ...

    @wp.kernel(module="unique")
    def call_broken(values: wp.array[float]):
        broken(values[wp.tid()])

    with pytest.raises(Exception, match="CUDA|compile|build"):
        compile_all([call_broken], tmp_path)


@pytest.mark.parametrize("file", FILES)
def test_kernels_of_a_file_compile_for_a_gpu(file: str, tmp_path: Path) -> None:
    module = importlib.import_module(file.removesuffix(".py").replace("/", "."))
    kernels = [value for value in vars(module).values() if isinstance(value, wp.Kernel) and not value.is_generic]
    files = compile_all(kernels, tmp_path)
    assert files == len({kernel.module for kernel in kernels})


def test_kernels_that_are_made_compile_for_a_gpu(tmp_path: Path) -> None:
    """Those that functions return: of the sweeps for each kind of element, and of the chain for its size."""
    import arcgym.sim

    assert arcgym.sim.Simulation
    kernels = [item for item in gc.get_objects() if type(item) is wp.Kernel]
    made = [k for k in kernels if k.func.__module__.startswith("arcgym.") and "<locals>" in k.func.__qualname__]
    names = {kernel.func.__name__ for kernel in made}
    assert {"sweep_color", "measure_bands"} <= names, names
    assert compile_all([warp_kernel(20, 40), *made], tmp_path) > len(names)
