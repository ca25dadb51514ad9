"""The types of arrays, by what stands in them; their shapes stand where they are used."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.intp]
Numbers = NDArray[np.int32]
Bools = NDArray[np.bool_]
AnyArray = NDArray[Any]
