"""Two boxes stand for a part when it throws a shadow."""

import numpy as np

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import box
from eyas.engine.render.pack.boxes import silhouette
from eyas.engine.state.mesh import Material


def test_a_box_is_found_as_it_is():
    waist, *ends = silhouette(box((10.0, 2.6, 3.0), (0.5, 0.0, 1.7), Material(), 1.0))
    assert np.isclose(waist, 0.2 + 0.6 * 3.0)
    np.testing.assert_allclose(ends, [-4.5, 5.5, -1.3, 1.3, -1.3, 1.3], atol=1e-5)


def test_a_cabin_is_shorter_and_narrower_than_its_body():
    body = box((4.4, 1.8, 0.8), (0, 0, 0.6), Material(), 1.0)
    cabin = box((2.0, 1.5, 0.6), (-0.3, 0, 1.3), Material(), 1.0)
    _, *ends = silhouette(concatenate([body, cabin]))
    np.testing.assert_allclose(ends, [-1.3, 0.7, -0.75, 0.75, -0.9, 0.9], atol=1e-5)


def test_handlebars_do_not_make_a_motorbike_wide():
    bike = box((2.2, 0.3, 0.8), (0, 0, 0.6), Material(), 1.0)
    bar = box((0.05, 1.1, 0.05), (0.7, 0, 0.8), Material(), 1.0)
    rider = box((0.5, 0.45, 0.6), (-0.2, 0, 1.3), Material(), 1.0)
    *_, right, left = silhouette(concatenate([bike, bar, rider]))
    assert 0.3 < left - right < 0.6
