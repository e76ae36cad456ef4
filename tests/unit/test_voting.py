import numpy as np
import pytest
from scenery import planar_scene
from test_evidence import pairs

from course_lib import voting
from course_lib.detectors import create_detector, detect
from course_lib.matching import match_brute_force
from course_lib.pairs import Pairs


@pytest.mark.parametrize(("n", "n_true"), [(100, 10), (250, 20), (40, 9), (1000, 60)])
def test_the_largest_group_is_mostly_true(n, n_true):
    first = next(voting.groups(pairs(n, n_true), 5.0))
    assert np.count_nonzero(first < n_true) >= 0.8 * n_true
    assert np.mean(first < n_true) > 0.5


def test_two_objects_are_two_groups():
    one, two = pairs(20, 20), pairs(20, 20, seed=1)
    both = Pairs(
        np.vstack([one.template_points, two.template_points]),
        np.vstack([one.scene_points, two.scene_points + np.array((200, -40))]),
        np.hstack([one.growth, two.growth]),
        np.hstack([one.turn, two.turn]),
        np.hstack([one.template_angles, two.template_angles]),
        np.vstack([one.noise, two.noise]),
    )
    first, second = list(voting.groups(both, 5.0))[:2]
    assert {tuple(np.unique(group // 20)) for group in (first, second)} == {(0,), (1,)}


def test_accidents_make_no_large_group():
    for seed in range(10):
        sizes = [len(group) for group in voting.groups(pairs(100, 0, seed), 5.0)]
        assert max(sizes, default=0) < 12


def test_many_copies_of_one_corner_do_not_outvote_an_object():
    true, copies = pairs(12, 12), pairs(12, 12, seed=3)
    crowd = Pairs(
        np.vstack([true.template_points, np.repeat(copies.template_points[:1], 30, axis=0)]),
        np.vstack([true.scene_points, np.repeat(copies.scene_points[:1] + 250, 30, axis=0)]),
        np.hstack([true.growth, np.repeat(copies.growth[:1], 30)]),
        np.hstack([true.turn, np.repeat(copies.turn[:1], 30)]),
        np.hstack([true.template_angles, np.repeat(copies.template_angles[:1], 30)]),
        np.vstack([true.noise, np.repeat(copies.noise[:1], 30, axis=0)]),
    )
    first = next(voting.groups(crowd, 5.0))
    assert np.count_nonzero(first < 12) >= 10


def test_pairs_read_the_keypoints():
    template, scene, _ = planar_scene(3)
    orb = create_detector("ORB", 300)
    left, right = (detect(orb, part[:, :, 1].copy(), 10**9) for part in (template, scene))
    matches = match_brute_force(left.descriptors, right.descriptors)[:50]
    matched = Pairs.of(matches, left, right)
    assert len(matched) == 50
    assert matched.oriented
    first, second = left.keypoints[matches[7].queryIdx], right.keypoints[matches[7].trainIdx]
    assert matched.template_points[7].tolist() == pytest.approx(first.pt)
    assert matched.scene_points[7].tolist() == pytest.approx(second.pt)
    assert matched.growth[7] == pytest.approx(second.size / first.size)
    assert np.cos(matched.turn[7]) == pytest.approx(np.cos(np.deg2rad(second.angle - first.angle)))
    assert len(Pairs.of([], left, right)) == 0
