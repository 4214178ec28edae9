# %% [markdown]
# # Compare methods on your own shape
#
# Every method that can, measured on one shape and one set of control points. This needs the
# package of the experiments, in a checkout:
#
#     pip install --editable '.[figures]' --editable ./research
#
# Put your files here. `None` takes the sample airplane, whose control points bend its wings
# up.

# %%
SHAPE = None  # "my-shape.obj"
POINTS = None  # "my-points.json", or any other file of landmarks with targets

# %%
import matplotlib.pyplot as plt

import neuralmls as nm
from neuralmls.figures.render import Panel, draw
from neuralmls.samples import make
from neuralmls.samples.sample import write_obj
from neuralmls_research.experiments.compare import attempt
from neuralmls_research.experiments.methods import METHODS

if SHAPE is None:
    sample = make("airplane")
    write_obj(sample, "airplane.obj")
    shape, points = nm.read("airplane.obj"), sample.control_points
else:
    shape, points = nm.read(SHAPE), nm.ControlPoints.read(POINTS)
shape

# %%
shape.plot(points, azimuth=-35, elevation=25, width=560)

# %% [markdown]
# ## Run
#
# `attempt` deforms and measures. A method that cannot do the shape says why, in a sentence,
# instead of a wrong answer.

# %%
NAMES = [name for name in METHODS if "shape-aware" not in name]  # these train for longer
p, q = points.sources, points.targets
results = {name: attempt(METHODS[name], shape, p, q) for name in NAMES}
done = [result for result in results.values() if result.positions is not None]
for result in results.values():
    if result.reason is not None:
        print(f"{result.title}: {result.reason}")

# %% [markdown]
# ## Look
#
# Blue balls are targets. A ball off the shape is a control point that did not arrive.

# %%
panels = [Panel("source", shape.positions, shape.faces)]
panels += [Panel(result.title, result.positions, shape.faces) for result in done]
draw(panels, control_points=points, width=900, columns=3, azimuth=-35, elevation=25)

# %% [markdown]
# ## Measure
#
# In halves of the shape's longest side. *Off targets*: how far the nearest vertex of each
# control point ends from its target, the paper's measure; *at points*: the same at the
# control point itself, which need not lie on the surface. *Curvature*: the mean change of
# mean curvature, the paper's distortion. *Median* beside the mean: a few bad triangles can
# make a mean. *Folded*: vertices where space is turned inside out.

# %%


def figure(value):
    """A figure for the table; where a method or a cloud without faces has none, a dash."""
    return f"{'-' if value is None else f'{value:.3g}':>12}"


columns = ("off targets", "at points", "curvature", "median", "folded", "seconds")
print(f"{'method':<32}" + "".join(f"{name:>12}" for name in columns))
for result in done:
    found, bend = result.measures, result.measures.curvature
    change = (None, None) if bend is None else (bend.mean, bend.median)
    row = (found.at_vertices, found.at_points, *change, found.folded, result.seconds)
    print(f"{result.title:<32}" + "".join(figure(value) for value in row))

# %% [markdown]
# One picture of it: down and to the left is better. A method that stays at the left arrives;
# one that stays low keeps the surface as it was.

# %%
plt.figure(figsize=(6.5, 4), dpi=80)
for result in done:
    found = result.measures
    if found.curvature is not None:
        plt.plot(found.at_vertices, found.curvature.mean, "o", markersize=9, label=result.title)
plt.xlabel("off targets, mean, halves of the longest side")
plt.ylabel("change of mean curvature, mean")
plt.legend(frameon=False, fontsize=9)
plt.show()

# %% [markdown]
# What not to conclude: one shape, one set of control points and one seed are an example and
# no result. `neuralmls compare` does the same from the command line and writes CSV;
# `neuralmls reproduce` has the paper's own experiments, and says which of its claims came out
# ([reproduction](../reproduction.md)).
#
# Next: [fit a map to landmarks](4-landmarks.ipynb).
