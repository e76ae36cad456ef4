import math

import numpy as np
import pytest

from course_lib.evidence import BELIEVED, consistent, distinct, landing_chance, log10_false_alarms
from course_lib.pairs import Pairs

H = np.array([[0.6, -0.3, 200], [0.3, 0.6, 60], [0, 0, 1.0]])
GROWTH, TURN = math.hypot(0.6, 0.3), math.atan2(0.3, 0.6)
SCENE = (640, 480)


def pairs(n, n_true, seed=0, *, oriented=True):
    """n_true matches that obey H, which turns and shrinks, and n - n_true accidents."""
    rng = np.random.default_rng(seed)
    source = rng.uniform(0, 400, (n, 2))
    target = rng.uniform(0, 1, (n, 2)) * SCENE
    growth = 2 ** rng.uniform(-2, 2, n)
    turn = rng.uniform(-np.pi, np.pi, n)
    target[:n_true] = source[:n_true] @ H[:2, :2].T + H[:2, 2] + rng.normal(0, 1, (n_true, 2))
    growth[:n_true] = GROWTH * 2 ** rng.normal(0, 0.2, n_true)
    turn[:n_true] = TURN + rng.normal(0, 0.1, n_true)
    unknown = np.full(n, np.nan)
    return Pairs(
        source,
        target,
        growth if oriented else unknown,
        turn if oriented else unknown,
        rng.uniform(0, 2 * np.pi, n),
        np.full((n, 2), 31.0),
    )


def alarms(n, n_true, seed=0, *, oriented=True):
    matched = pairs(n, n_true, seed, oriented=oriented)
    mapped = matched.template_points @ H[:2, :2].T + H[:2, 2]
    inliers = np.linalg.norm(mapped - matched.scene_points, axis=1) <= 5
    points = np.random.default_rng(9).uniform(0, 1, (1000, 2)) * SCENE
    return log10_false_alarms(H, matched, inliers, points.astype(np.float32), SCENE, 5.0)


@pytest.mark.parametrize(("n_true", "n"), [(9, 25), (9, 40), (18, 40), (20, 100), (20, 250)])
def test_hard_but_real_agreements_are_believed(n_true, n):
    # The linear rule, more than 8 + 0.3 n, refuses every one but 18 of 40.
    assert alarms(n, n_true) < BELIEVED


@pytest.mark.parametrize(("n_true", "n"), [(0, 25), (4, 25), (5, 100), (6, 1000)])
def test_what_chance_can_do_is_not_believed(n_true, n):
    assert alarms(n, n_true) > BELIEVED


def test_more_inliers_are_more_evidence_and_more_matches_less():
    by_inliers = [alarms(100, k) for k in (8, 12, 20, 40)]
    assert by_inliers == sorted(by_inliers, reverse=True)
    by_matches = [alarms(n, 12) for n in (20, 50, 100, 400)]
    assert by_matches == sorted(by_matches)


def test_size_and_angle_are_evidence():
    assert alarms(60, 10) < alarms(60, 10, oriented=False) - 3


def test_consistency_follows_the_homography():
    matched = pairs(200, 100)
    agrees = consistent(H, matched)
    assert agrees[:100].mean() > 0.95
    assert agrees[100:].mean() < 0.2
    assert consistent(H, pairs(50, 0, oriented=False)).all()


def test_one_corner_in_many_octaves_counts_once():
    spots = np.array([[10, 10], [11, 10], [10, 12], [100, 100], [101, 101.0]])
    assert distinct(spots, 5) == 2
    assert distinct(np.empty((0, 2)), 5) == 0
    matched = pairs(100, 12)
    crowded = Pairs(
        np.repeat(matched.template_points[:3], 4, axis=0),
        np.repeat(matched.scene_points[:3], 4, axis=0),
        matched.growth[:12],
        matched.turn[:12],
        matched.template_angles[:12],
        matched.noise[:12],
    )
    points = np.zeros((2, 2), np.float32)
    assert log10_false_alarms(H, crowded, np.ones(12, bool), points, SCENE, 5.0) == math.inf


def test_bunched_keypoints_make_accidents_likelier():
    rng = np.random.default_rng(0)
    even = (rng.uniform(0, 1, (1000, 2)) * SCENE).astype(np.float32)
    bunched = (rng.uniform(0, 0.2, (1000, 2)) * SCENE).astype(np.float32)
    uniform = math.pi * 25 / (640 * 480)
    assert landing_chance(even, SCENE, 5) == pytest.approx(uniform, rel=0.5)
    assert landing_chance(bunched, SCENE, 5) > 10 * uniform
    assert landing_chance(np.empty((0, 2), np.float32), SCENE, 5) == pytest.approx(uniform)
    assert landing_chance(np.zeros((50, 2), np.float32), SCENE, 5) == 1
