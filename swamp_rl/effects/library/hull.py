"""What differs in the hull: its mass, its resistance and its damping."""

from swamp_rl.effects.declare import Parameter, declare
from swamp_rl.effects.search import Search

DERIVATIVE = Search(0.1, 0.425, 1.6, (1.0,), prior=0.12)  # from a regression over other hulls
SIDE = Search(0.3, 0.0, 6.0, (1.2,))

declare(
    "mass",
    Parameter("mass", "kg", None, "mass", low=0.0, above_low=True, search=Search(0.15, 0.4, 2.5, (), "mass")),
    acts_on="force",
    combine="replace",
    description="the boat's mass with its payload",
    source="thesis 4.2.1 and 8.1.3",
    scope="day",
)

declare(
    "centre_of_gravity",
    Parameter("x_g", "m", None, "x_g", search=Search(0.04, -0.4, 0.4, (), "length")),
    acts_on="force",
    combine="replace",
    description="centre of gravity, forward of midship",
    source="thesis 8.14: a payload that is not amidships",
)

declare(
    "yaw_inertia",
    Parameter("scale", "1", 1.0, "inertia_z", low=0.0, above_low=True, search=Search(0.2, 0.2, 5.0, (1.1,))),
    acts_on="force",
    combine="multiply",
    description="that multiple of the boat's own moment of inertia in yaw, without the water's",
    source="thesis 8.1.3 has it from CAD",
    steady=False,
)

declare(
    "resistance",
    Parameter("scale", "1", 1.0, "resistance_scale", low=0.0, search=Search(0.2, 0.05, 6.0, (1.1,))),
    acts_on="force",
    combine="multiply",
    description="that multiple of the boat file's surge resistance, its towing tank's or X'_0; linear drag "
    "and the drag across keep their size: weed that raises all drag by one factor has a larger scale",
    source="ours: fouling, appendages, load",
)

declare(
    "drag_asymmetry",
    Parameter("astern", "1", 1.0, "astern_drag", low=0.0, search=SIDE),
    Parameter("port", "1", 1.0, "port_drag", low=0.0, search=SIDE),
    acts_on="force",
    combine="multiply",
    description="the surge resistance astern is that multiple of the resistance ahead, the cross-flow drag "
    "force to port that multiple of the one to starboard",
    source="ours: a transom, skegs, a bent strut",
)

declare(
    "linear_drag",
    Parameter(
        "coefficient", "N s/m", 0.0, "linear_drag", search=Search(0.0852, -1.136, 2.27, (0.0568,), "damping")
    ),
    acts_on="force",
    combine="add",
    description="a surge resistance in proportion to the speed through the water",
    source="ours: what a square law leaves out at low speed",
)

declare(
    "linear_sway_damping",
    Parameter(
        "coefficient", "N s/m", 0.0, "linear_sway_damping", search=Search(0.2, -1.1, 6.0, (0.15,), "damping")
    ),
    acts_on="force",
    combine="add",
    description="a sway resistance in proportion to the sway through the water, -Y_v at zero speed",
    source="Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control (2021): linear damping",
)

declare(
    "linear_yaw_damping",
    Parameter(
        "coefficient",
        "N m s/rad",
        0.0,
        "linear_yaw_damping",
        search=Search(0.04, -0.4, 2.0, (0.02,), "yaw_damping"),
    ),
    acts_on="force",
    combine="add",
    description="a moment against turning in proportion to the yaw rate, -N_r at zero speed",
    source="Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control (2021): linear damping",
)

declare(
    "sway_drag",
    Parameter("scale", "1", 1.0, "c_d", low=0.0, search=Search(0.2, 0.0, 6.0, (1.1,))),
    acts_on="force",
    combine="multiply",
    description="that multiple of the cross-flow drag coefficient",
    source="thesis 8.1.3: a regression for other hulls",
)

declare(
    "yaw_damping",
    Parameter("scale", "1", 1.0, "n_r", search=Search(0.3, -3.0, 8.0, (1.1,))),
    acts_on="force",
    combine="multiply",
    description="that multiple of N'_r",
    source="thesis 8.1.3: a regression for other hulls",
)

declare(
    "hull_coefficients",
    *(Parameter(name, "1", 1.0, name, search=DERIVATIVE) for name in ("x_vr", "y_v", "y_r", "n_v", "n_r")),
    acts_on="force",
    combine="multiply",
    description="multiples of the linear hull derivatives",
    source="thesis 8.1.3: no real boat has exactly its regression's",
)

declare(
    "demihull_spacing",
    Parameter(
        "spacing", "m", None, "hull_spacing", low=0.0, search=Search(0.2, 0.0, 2.0, (0.4, 0.9), "breadth")
    ),
    acts_on="force",
    combine="replace",
    description="two demihulls that far apart, each meeting its own surge speed: a moment that damps turns",
    source="thesis table 4.1; a catamaran's resistance acts on each hull",
)

declare(
    "hull_asymmetry",
    Parameter(
        "yaw_moment",
        "N m s2/m2",
        0.0,
        "asymmetry_yaw",
        search=Search(0.0317, -0.952, 0.952, (0.0,), "asymmetry"),
    ),
    acts_on="force",
    combine="add",
    description="a yaw moment times surge times its magnitude, of hulls that are not alike",
    source="paper on SWAMP's identification: a bias to port",
)

declare(
    "force_curve",
    acts_on="force",
    combine="add",
    description="a force, a moment or the thrust of a thruster as a function of one variable, by knots or by "
    "a formula, zero outside the knots",
    source="ours: what no other effect names, as a diagnosis estimates it",
    curve=True,
    begin=None,
)
