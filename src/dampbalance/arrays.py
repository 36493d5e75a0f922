"""Types of arrays, named once for the whole package."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Mask = NDArray[np.bool_]
Codes = NDArray[np.uint8]
Integers = NDArray[np.int64]
Words = NDArray[Any]
"""Words or other objects."""
