# %% [markdown]
# # Temperature, alpha and epsilon
#
# Three numbers say how far a control point reaches. First on a line, where everything can be
# seen at once; then on a shape.

# %%
import matplotlib.pyplot as plt
import numpy as np

import neuralmls as nm

plt.rcParams.update({"figure.figsize": (9, 2.6), "figure.dpi": 80})

p = np.array([[-1.0], [-0.2], [0.1], [1.0]])  # control points on a line, not evenly spread
x = np.linspace(-1.3, 1.3, 521)[:, None]


def draw(functions, temperatures=(1.0,)):
    """The weights of each control point along the line, a panel a function and temperature."""
    panels = [(title, f, T) for title, f in functions.items() for T in temperatures]
    _, all_axes = plt.subplots(1, len(panels), sharey=True, layout="constrained")
    for axes, (title, f, T) in zip(all_axes, panels, strict=True):
        axes.plot(x, nm.softmax(f.logits(x), T))
        axes.plot(p, np.zeros(len(p)), "o", color="black", markersize=4)
        axes.set_title(f"{title}, T = {T:g}" if len(temperatures) > 1 else title, fontsize=10)
    plt.show()


# %% [markdown]
# ## Temperature
#
# $$w(x) = \mathrm{softmax}\left(\mathrm{logits}(x) / T\right)$$
#
# A lower temperature makes a point listen to fewer control points: plateaus with steep flanks
# between them. A higher one blends more. The network is the same in all of these; only the
# softmax is another.

# %%
neural = nm.NeuralWeights.fit(p, bounds=[[-1], [1]], steps=48)
draw({"neural": neural}, temperatures=(2, 1, 0.5))

# %% [markdown]
# What it does to a motion: the third control point is lifted from 0.1 to 0.5. At a low
# temperature what lies on its plateau goes with it, and the rest stays.

# %%
q = p + [[0.0], [0.0], [0.4], [0.0]]
deformer = nm.Deformer(x, neural)
for T in (2, 1, 0.5):
    plt.plot(x, deformer.deform(q, T) - x, label=f"T = {T:g}")
plt.plot(p, q - p, "o", color="black", label="control points")
plt.ylabel("moved by")
plt.legend(frameon=False, fontsize=9)
plt.show()

# %% [markdown]
# Where the control point does not own its place, at the highest temperature, the curve passes
# below its dot: these are *soft* handles, the paper's way. `handles="auto"`, the default of
# `nm.Session` and `nm.deform`, aims further so that they arrive.
#
# ## Alpha
#
# The classic weights have no temperature but an exponent:
#
# $$w_i(x) \propto \frac{1}{d_i^{2\alpha}}, \qquad \mathrm{logits}_i = -\alpha \log d_i^2$$
#
# Dividing these logits by $T$ is the same as multiplying $\alpha$ by $1/T$. So alpha *is* an
# inverse temperature: `alpha=0.5` is $1/d$, `alpha=1` is $1/d^2$. Whatever alpha is, the
# weight is 1 at the control point and nowhere else, and far away all control points count
# alike: see the outer ends of the curves.

# %%
draw({f"alpha = {alpha:g}": nm.InverseDistanceWeights(p, alpha=alpha) for alpha in (0.5, 1, 2)})
squared = nm.softmax(nm.InverseDistanceWeights(p, alpha=2).logits(x))
cooled = nm.softmax(nm.InverseDistanceWeights(p, alpha=1).logits(x), 0.5)
print("alpha = 2 and alpha = 1 at T = 0.5 are the same:", np.allclose(squared, cooled))

# %% [markdown]
# ## Epsilon
#
# $$w_i(x) \propto \frac{1}{d_i^{2\alpha} + \varepsilon}$$
#
# caps the peak, and rounds it. The price: no control point has all the weight at its own
# place any more, so that soft handles stop short.

# %%
capped = {
    f"epsilon = {epsilon:g}": nm.InverseDistanceWeights(p, epsilon=epsilon)
    for epsilon in (0, 0.01, 0.1)
}
draw(capped)
print("weights of control points at their own places")
for title, f in capped.items():
    print(f"{title:<16}", nm.softmax(f.logits(p)).diagonal().round(2))

# %% [markdown]
# ## On a shape
#
# The weight of one control point of the sample table, at three temperatures and by the
# classic weights. `Panel` and `draw` are what `plot()` is made of: pictures side by side
# under one camera.

# %%
from neuralmls.figures import render
from neuralmls.samples import make

table = make("table")
points, vertices = table.control_points, table.vertices
bounds = [vertices.min(axis=0), vertices.max(axis=0)]
number = points.names.index("top-front-right")
learned = nm.NeuralWeights.fit(points.sources, bounds=bounds)
classic = nm.InverseDistanceWeights(points.sources, bounds=bounds)

panels = [
    render.Panel(
        title, vertices, table.triangles, weights=nm.softmax(f.logits(vertices), T)[:, number]
    )
    for title, f, T in (
        ("neural, T = 2", learned, 2),
        ("neural, T = 1", learned, 1),
        ("neural, T = 0.5", learned, 0.5),
        ("classic, alpha = 1", classic, 1),
    )
]
render.draw(panels, width=800, columns=2, azimuth=-25)

# %% [markdown]
# Neural weights have a border, which the temperature makes steeper. Classic ones fade, and
# are nowhere quite 0: the shelf has a tint of a corner that is far above it.
#
# How much of the table moves when this corner is lifted?

# %%
moved = nm.ControlPoints(points.sources, names=points.names).moved(
    {"top-front-right": [0, 0.15, 0.1]}
)
panels = [render.Panel("at rest", vertices, table.triangles)]
for title, kind in (("neural", "neural"), ("classic", "inverse-distance")):
    y = nm.deform(vertices, moved.sources, moved.targets, weights=kind)
    panels.append(render.Panel(title, y, table.triangles))
    far = np.linalg.norm(y - vertices, axis=1)
    share = np.mean(far > 0.01 * far.max())
    print(f"{title}: {share:.0%} of the vertices move by over 1 % of what the farthest moves")
render.draw(panels, control_points=moved, width=900, azimuth=-25)

# %% [markdown]
# Next: [compare methods on your own shape](3-compare-methods.ipynb). How closely handles
# arrive: [handles](../handles.md).
