"""Cases from dataclasses, with the units in the names of their fields.

A field ``young_modulus_pa`` is the key ``young_modulus`` of a case file, in Pa. Fields that are
``None`` are left out, and the defaults of the case file count. ``mtled case schema`` describes
every key; the names of laws, clouds and solvers are those of the case file.
"""

from .conditions import (
    BodyForce,
    Data,
    Displacement,
    Formula,
    InitialVelocity,
    Linear,
    Obstacle,
    Prescribe,
    Pressure,
    Rotation,
    Smooth,
    Table,
    Traction,
)
from .recipe import Grid, Material, OgdenTerm, Recipe, RefineCell, RefineSpacing, Region
from .shapes import (
    Box,
    Cylinder,
    Difference,
    Distance,
    Ellipsoid,
    Facing,
    HalfSpace,
    InShape,
    Intersection,
    Label,
    LabelMap,
    Not,
    Plane,
    Polygon,
    Sphere,
    Stl,
    Union,
)
from .statement import Problem
from .tables import key_of
from .time import Dynamic, Lattice, Output, PlaneStrain, Points, Probe, Static

__all__ = [
    "BodyForce",
    "Box",
    "Cylinder",
    "Data",
    "Difference",
    "Displacement",
    "Distance",
    "Dynamic",
    "Ellipsoid",
    "Facing",
    "Formula",
    "Grid",
    "HalfSpace",
    "InShape",
    "InitialVelocity",
    "Intersection",
    "Label",
    "LabelMap",
    "Lattice",
    "Linear",
    "Material",
    "Not",
    "Obstacle",
    "OgdenTerm",
    "Output",
    "Plane",
    "PlaneStrain",
    "Points",
    "Polygon",
    "Prescribe",
    "Pressure",
    "Probe",
    "Problem",
    "Recipe",
    "RefineCell",
    "RefineSpacing",
    "Region",
    "Rotation",
    "Smooth",
    "Sphere",
    "Static",
    "Stl",
    "Table",
    "Traction",
    "Union",
    "key_of",
]
