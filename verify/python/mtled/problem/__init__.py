"""Cases from dataclasses, with the units in the names of their fields.

A field ``young_modulus_pa`` is the key ``young_modulus`` of a case file, in Pa. Fields that are
``None`` are left out, and the defaults of the case file count. What a table needs, a vector and its
components may be given without their names; all else goes by name.
"""

# ruff: noqa: F403
from ._conditions import *
from ._materials import *
from ._problem import *
from ._recipe import *
from ._shapes import *
from ._statement import *
from ._tables import *
