"""Average linkage is SciPy's, whatever the order of the joins."""

import numpy as np
import pytest
from scipy.cluster import hierarchy
from scipy.spatial.distance import squareform

from jackettwin.identification.linkage import average_linkage


@pytest.mark.parametrize("n", [2, 7, 60, 200])
@pytest.mark.parametrize("farthest", [0.02, 0.1, 0.5])
def test_the_groups_are_those_of_scipy(rng: np.random.Generator, n: int, farthest: float) -> None:
    place = rng.uniform(size=(n, 2))
    apart = np.linalg.norm(place[:, None] - place, axis=2)
    tree = hierarchy.linkage(squareform(apart, checks=False), method="average")
    label = hierarchy.fcluster(tree, farthest, criterion="distance")
    expected = sorted(np.flatnonzero(label == k).tolist() for k in np.unique(label))
    assert sorted(group.tolist() for group in average_linkage(apart, farthest)) == expected
