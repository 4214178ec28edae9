# %% [markdown]
# # Fit a map to landmarks
#
# Two lists of landmarks, one on an atlas, one on a subject: the map between them carries
# everything else along, whatever it is: meshes, clouds, electrodes, other landmarks. Here the
# truth is known, because the subject is made from the atlas by a formula; so the error of the
# map can be measured anywhere.

# %%
import matplotlib.pyplot as plt
import numpy as np

import neuralmls as nm
from neuralmls.samples import make

sample = make("airplane")
atlas, faces = sample.vertices, sample.triangles


def truth(x):
    """The subject: wings bent up and swept back, the body turned a little."""
    squared = x[:, :1] ** 2
    bent = x + squared * [0, 0.02, -0.012]
    c, s = np.cos(0.2), np.sin(0.2)
    return bent @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + [1, 0, 2]


# %% [markdown]
# ## Landmarks, as they come
#
# Sixteen on the atlas, the same sixteen on the subject, measured to about 2 cm on a wing span
# of 22 m. They are written as tables here, to be read as yours would be: CSV of any tool, 3D
# Slicer, MeshLab, IDAV Landmark, tps and others ([control points](../control-points.md)).

# %%
random = np.random.default_rng(0)
at = nm.farthest_points(atlas, faces, 16)
names = [f"L{i + 1}" for i in range(len(at))]
nm.ControlPoints(at, names=names).write("atlas.csv")
order = random.permutation(len(at))  # the second file need not be in the order of the first
measured = truth(at) + random.normal(0, 0.02, at.shape)
nm.ControlPoints(measured[order], names=[names[i] for i in order]).write("subject.csv")

session = nm.Session.read("atlas.csv", targets="subject.csv")  # joined by name
session

# %% [markdown]
# Is something wrong with them? Mirrored axes, other units, landmarks on a line are said in a
# sentence. Here, nothing:

# %%
box = np.stack([atlas.min(axis=0), atlas.max(axis=0)])
print(session.points.check(box))

# %% [markdown]
# and this is what is said where somebody's axes are others:

# %%
mirrored = session.points.with_targets(session.points.targets * [-1, 1, 1])
print(*mirrored.check(box), sep="\n")

# %% [markdown]
# ## Fit

# %%
map = session.fit(atlas)
report = map.report()
print("handles:", report.handles)
print(f"farthest from its target: {report.distance_to_target.max():.4f} m")
map.plot(atlas, faces, heat="displacement", azimuth=-35, elevation=25)

# %% [markdown]
# ## How wrong is it, between the landmarks?
#
# On the subject, nobody knows: so leave each landmark out, fit the others, and see where it
# is put. Here we know the truth too, and can see what that estimate is worth.


# %%
def left_out(session):
    """How far each landmark is from where the map of all others puts it, (m,)."""
    p, q = session.points.sources, session.points.targets
    errors = []
    for i in range(len(p)):
        others = session.replace(
            points=nm.ControlPoints(np.delete(p, i, 0), np.delete(q, i, 0)), frame=box
        )
        errors.append(np.linalg.norm(others.fit().at(p[i : i + 1]) - q[i]))
    return np.array(errors)


def true_error(session):
    """How far the vertices are from the truth, (n,)."""
    return np.linalg.norm(session.fit(atlas).at(atlas) - truth(atlas), axis=1)


rows = {
    "neural, rigid": session,
    "neural, affine": session.replace(transform="affine"),
    "neural, affine, T = 2": session.replace(transform="affine", temperature=2),
    "classic 1/d^2, rigid": session.replace(weights="inverse-distance"),
    "classic 1/d^2, affine": session.replace(weights="inverse-distance", transform="affine"),
}
print(f"{'':<24}{'left out, median':>18}{'truth, median':>16}{'truth, worst':>15}")
for title, one in rows.items():
    error = true_error(one)
    said = np.median(left_out(one)), np.median(error), error.max()
    print(f"{title:<24}{said[0]:>16.3f} m{said[1]:>14.3f} m{said[2]:>13.3f} m")

# %% [markdown]
# The estimate is pessimistic: a landmark that is left out leaves a gap that the map does not
# have. It need not even put the methods into the right order: compare the columns before you
# choose by it.
#
# ## How many landmarks?

# %%
counts = (4, 8, 12, 16, 24, 32)
at = nm.farthest_points(atlas, faces, counts[-1])  # the first k of these are well spread too
measured = truth(at) + random.normal(0, 0.02, at.shape)
plt.figure(figsize=(6.5, 3.5), dpi=80)
for transform in ("rigid", "affine"):
    errors = []
    for k in counts:
        landmarks = nm.ControlPoints(at[:k], measured[:k])
        errors.append(np.median(true_error(nm.Session(landmarks, transform=transform))))
    plt.semilogy(counts, errors, "o-", label=f"neural, {transform}")
plt.axhline(0.02, color="grey", linestyle=":", label="error of a measured landmark")
plt.xlabel("landmarks")
plt.ylabel("median error of a vertex, m")
plt.legend(frameon=False)
plt.show()

# %% [markdown]
# ## Keep it, and carry other things along
#
# The map is a function of space. Saved, it gives the same result on every machine; weights
# are stored bit for bit, and nothing in the file is executed.

# %%
map.save("atlas-to-subject.safetensors")
again = nm.Map.load("atlas-to-subject.safetensors")
seats = np.stack(
    [np.zeros(5), np.full(5, 0.3), np.linspace(-6, 6, 5)], axis=1
)  # other points, never seen
print("the same bits:", np.array_equal(again.at(seats), map.at(seats)))
print("off the truth by", np.linalg.norm(again.at(seats) - truth(seats), axis=1).round(3), "m")

# %% [markdown]
# A landmark that you trust less gets a `weight` below 1: then the map goes near it and not
# through it ([handles](../handles.md)). From the command line: `neuralmls deform atlas.obj
# --points atlas.csv --targets subject.csv -o bent.obj` ([maps](../maps.md)).
