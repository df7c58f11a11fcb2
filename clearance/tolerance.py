"""Every numeric tolerance of the package: its value, its unit and the reason for it.

Not for: thresholds that are exact by construction (predicates) and error bounds that are computed.
"""

UNIT_ROUNDOFF = 2.0**-53
"""Largest relative error of one rounded float64 operation."""

TESSELLATION = 1e-4
"""[m] How far a facet of a round shape may stand outside the true surface, by default: below the
repeatability of industrial arms (about 0.1 mm, ISO 9283 data sheets), so it never decides a verdict."""

FINEST_TESSELLATION, COARSEST_TESSELLATION = 5e-5, 0.1
"""[m] Tolerances of CAD files that can be asked for: faces of real models are up to 0.02 mm apart at their edges,
whatever accuracy their file states, so that no finer facets would be nearer to anything."""

ROTATION = 1e-6
"""[-] How far a given quaternion's norm or a matrix's R^T R may be from unity: YAML files carry six or more
digits; anything worse is a typing error, not a rounding."""

ROUNDED_ROTATION = 1e-3
"""[-] How far a quaternion of three digits (0.707) may be from length 1: files of other programs hold such."""

CROSS_CHECK = 1e-9
"""[-] Greatest difference between our clearance and FCL's, relative to the scene's size, that counts as
agreement: FCL's triangle kernel loses up to 1e-10 in millimetres on slender triangles."""

FLATNESS = 1e-9
"""[-] How far a polygon's vertices may be off its plane, relative to its radius, and how far it may bend
inward (sine of the angle), beside the rounding of its coordinates: a thousand times what a rigid motion in
float64 does to it near the origin, and a hundred times less than the rounding of coordinates in a float32 or
six-digit file, whose polygons are cut into triangles instead."""

CERTIFY_GAP = 1e-4
"""[m] How far a certified bound may stay below a distance that occurs, by default: as fine as the facets."""

PATH_ERROR = 1e-8
"""[rad or m] How far the cubics by which a quintic is followed may be off it: some 0.1 um at the tool of an arm,
which clearances are lessened by, for 5 to 20 samples in a tenth of a second of an arm's motion."""

FINEST_CERTIFY_GAP = 2.0**-32
"""[-] The least such gap, relative to how far the bodies of a case reach from the origin: 2^21 roundings. Near a
limit a thousandth of it is asked for, twice what rounding of poses and bounds takes; below that nothing is proven
however finely the motion is parted."""

AT_LEVEL = 2.0**-38
"""[-] A clearance is at a level where it is below by no more than this, relative to how far the bodies reach from
the origin: the rounding of the finest proof, of which 2^-39 was seen. Distances are off by far less."""

SEEN_AT_LEVEL = 4.0
"""[-] So many times `AT_LEVEL` above a level nothing is told from the level: what a proof sees is told up to twice
that above what occurs, and a proof to tell them apart takes more than the work for one level."""

LARGEST = 1e150
"""[m] No coordinate may be larger in magnitude: its square must not overflow."""

REACH = 1e6
"""[m] No body of a case may get farther from the origin: nothing that a robot works on does, and a value in the
wrong unit, or a typing error in an exponent, does at once."""

TURNS = 1000.0
"""[turns] No joint turns farther between two samples: no machine is sampled so coarsely, an angle in the wrong
unit or a typing error does at once, and proofs between the samples take as long as the way (2 to 6 ms a turn)."""

CURVE_SIZES = 1e-100, 1e100
"""[-] A curve is larger than the first and smaller than the second: no square of a length leaves floats' range."""

MEETING = 1e-9
"""[-] Parts of a chain meet where their ends are this near, relative to the curve's size: drawings are written
with nine digits or more, and a gap that is meant is far larger."""

CLOSED = 1e-12
"""[-] A contour is closed where its ends are this near, relative to the curve's size: above what rounding does
to the ends of arcs and splines that are meant to close."""

TANGENT = 1e-9
"""[-] Sine of the angle between two pieces of a curve from which on their joint is a corner: knots and control
points that are meant smooth meet within 1e-12, corners that are meant differ by far more."""

NORMAL = 1e-6
"""[-] Cosine of the angle between a curve and the line of its distance up to which that line is a normal: it
names the kind of a solution and decides no distance."""

PARAMETER = 1e-12
"""[-] Local parameters this near to 0 or 1 are the end of a piece, angles this near to a quarter or full turn
are that turn: what rounding does to them, several times over."""

BIARC = 2e-3
"""[-] How far the biarcs that guide the search on a curve may stray from it, relative to the curve's size:
measured as the fastest; any value gives the same answer."""

FINEST_BIARC = 1e-12
"""[-] No finer biarcs than this, relative to the curve's size, can be proven in floats."""

SHARPER = 2.0**-10
"""[-] A search of a Hausdorff distance aims this much below the tolerance asked for, so that coincident curves
come out to rounding."""

LAST_BITS = 2.0**-50
"""[-] Relative to the size of two curves: the rounding of a few operations beyond those that bounds count."""

TIE = 2.0**-44
"""[-] Relative to the size of two curves: how far above a limit, beyond the rounding of points, a proven bound
of their Hausdorff distance may be that still counts as at the limit: the rounding of the longest bounds."""

WEIGHTS = 1e6
"""[-] The greatest ratio of a curve's weights: drawings have 2 to 50. At 1e8 half a piece may lie within 1e-8 of
an end of its parameter, and a search takes seconds; at 1e16 floats end before the piece does."""

LEAST_GAP = 2.0**-44
"""[-] Relative to the size of two curves: how near the bounds of their least distance come; above the rounding of
projections, or cells would never end."""

EXCURSION = 1e-5
"""[-] Relative to the size of two curves: how far a deviation may pass its limit between samples unseen; finer
than any drawing is made, and coarse enough that a curve that runs at its limit takes 1e5 samples."""
