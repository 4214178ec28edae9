# %% [markdown]
# # A first deformation
#
# A few **control points** are moved, and the whole shape follows. What follows how far is
# said by **weights**: a small network is trained, in a fraction of a second, on nothing but
# the control points at rest. Moving least squares turns the weights into a motion.
#
# This takes a sample that the package makes. For a shape of yours, replace `chair =
# nm.read(...)`: OBJ, PLY, OFF, STL, glTF, point clouds.

# %%
import numpy as np

import neuralmls as nm
from neuralmls.samples import make
from neuralmls.samples.sample import write_obj

sample = make("chair")
write_obj(sample, "chair.obj")
chair = nm.read("chair.obj")
chair

# %% [markdown]
# The sample comes with twelve control points and a place where each is to go: the feet down,
# the back to lean.

# %%
points = sample.control_points
points

# %%
chair.plot(points)

# %% [markdown]
# ## Fit, and look
#
# A **session** is control points and settings. Fitted, it is a **map**: it says of each point
# of space where it goes.

# %%
map = nm.Session(points).fit(chair)
map.plot(chair)

# %% [markdown]
# Did the control points arrive? Did anything go wrong? `report` tells of the control points,
# `advise` looks at the whole shape.

# %%
report = map.report(chair)
print("handles:", report.handles)
print("farthest from its target:", f"{1000 * report.distance_to_target.max():.3f} mm")
warnings = [*report.warnings, *(advice.sentence for advice in map.advise(chair))]
print("warnings:", *(warnings or ["none"]), sep="\n    ")

# %% [markdown]
# ## The weights
#
# For each point $x$ there is a weight of each control point, and they sum to 1:
#
# $$w(x) = \mathrm{softmax}\left(\mathrm{network}(x) / T\right)$$
#
# Here is where the control point `seat-back-left` rules: its corner of the seat, the leg
# below, the post above, and half of the slats. The network knows the control points, not the
# shape (`weights="shape-aware"` is for shapes where parts that lie side by side must not
# follow each other).

# %%
map.plot(chair, heat="seat-back-left")

# %% [markdown]
# The same as numbers, for the vertices or for any points:

# %%
w = nm.softmax(map.weights.logits(chair.positions), map.session.settings["temperature"])
print("weights:", w.shape, "whose rows sum to 1:", np.allclose(w.sum(axis=1), 1))
at_home = nm.softmax(map.weights.logits(points.sources), 1.0).diagonal()
print("of each control point at its own place: at least", at_home.min().round(3))

# %% [markdown]
# ## Drag on
#
# The network has never seen the targets. So moving a control point needs no training, and a
# frame takes milliseconds ([performance](../performance.md)). The colours show how far each
# vertex moves.

# %%
at_rest = points.with_targets(points.sources)
wide = at_rest.moved({"armrest-left": [0.12, 0.05, 0], "armrest-right": [-0.12, 0.05, 0]})
map.moved(wide).plot(chair, heat="displacement")

# %% [markdown]
# ## Keep it
#
# The file is written with new positions and everything else as it was: groups, materials,
# texture coordinates, n-gons. `maps` are the local rotations, by which its normals turn.

# %%
y, maps = map.deform(chair, return_maps=True)
written = chair.write("bent.obj", y, maps=maps)
bent = nm.read("bent.obj")
print([path.name for path in written], "same faces:", np.array_equal(bent.faces, chair.faces))
chair.write("unmoved.obj", chair.positions)
with open("chair.obj", "rb") as before, open("unmoved.obj", "rb") as after:
    print("unmoved, the same bytes:", before.read() == after.read())

# %% [markdown]
# ## Control points of your own
#
# Spread over the shape, as a start; then name them, move them, add some where parts are to
# stay.

# %%
spread = nm.ControlPoints(nm.farthest_points(chair.positions, chair.faces, 8)).moved(
    {"p1": [0, 0.1, 0.1]}
)
nm.Session(spread).fit(chair).plot(chair, heat="p1")

# %% [markdown]
# Next: [temperature, alpha and epsilon](2-temperature-alpha-epsilon.ipynb).
