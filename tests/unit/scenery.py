"""Synthetic pictures with exactly known geometry, for the tests of localisation."""

import cv2
import numpy as np

TEMPLATE_SIZE = (400, 300)
SCENE_SIZE = (640, 480)


def texture(rng, size=SCENE_SIZE):
    """Bars, discs, letters and lines of many sizes: corners that every detector likes."""
    width, height = size
    picture = np.full((height, width, 3), rng.integers(60, 200, 3), np.uint8)
    for _ in range(width * height // 2500):
        x, y = int(rng.integers(0, width)), int(rng.integers(0, height))
        ink = tuple(int(c) for c in rng.integers(0, 256, 3))
        shape = rng.integers(0, 4)
        if shape == 0:
            corner = (x + int(rng.integers(5, 70)), y + int(rng.integers(5, 70)))
            cv2.rectangle(picture, (x, y), corner, ink, -1)
        elif shape == 1:
            cv2.circle(picture, (x, y), int(rng.integers(3, 30)), ink, -1, cv2.LINE_AA)
        elif shape == 2:
            letter, scale = chr(int(rng.integers(65, 91))), float(rng.uniform(0.5, 2.5))
            cv2.putText(picture, letter, (x, y), 0, scale, ink, 3, cv2.LINE_AA)
        else:
            end = (x + int(rng.integers(-90, 90)), y + int(rng.integers(-90, 90)))
            cv2.line(picture, (x, y), end, ink, int(rng.integers(1, 6)), cv2.LINE_AA)
    return picture


def photographed(rng, picture, *, blur=0.0, noise=3.0, quality=90):
    """What a camera makes of it: blur, noise, JPEG."""
    if blur:
        picture = cv2.GaussianBlur(picture, (0, 0), blur)
    noisy = np.clip(picture + rng.normal(0, noise, picture.shape), 0, 255).astype(np.uint8)
    _, data = cv2.imencode(".jpg", noisy, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return cv2.imdecode(data, cv2.IMREAD_COLOR)


def view(rng, *, tilt, scale):
    """H_scene_from_template of a pinhole camera that looks at a tilted plane."""
    roll = rng.uniform(-np.pi, np.pi) if rng.random() < 0.5 else rng.uniform(-0.4, 0.4)
    R = np.eye(3)
    for axis, angle in ((0, rng.uniform(-tilt, tilt)), (1, rng.uniform(-tilt, tilt)), (2, roll)):
        turn = np.zeros(3)
        turn[axis] = angle
        R = R @ cv2.Rodrigues(turn)[0]
    focal, (width, height) = 700.0, SCENE_SIZE
    K = np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]])
    depth = focal / scale
    aside = rng.uniform(-0.2, 0.2, 2) * SCENE_SIZE / scale
    centre = np.array([[1, 0, -(TEMPLATE_SIZE[0] - 1) / 2], [0, 1, -(TEMPLATE_SIZE[1] - 1) / 2]])
    H = K @ np.column_stack([R[:, :2], [*aside, depth]]) @ np.vstack([centre, [0, 0, 1]])
    return H / H[2, 2]


def corners_of(H, size=TEMPLATE_SIZE):
    right, bottom = size[0] - 1, size[1] - 1
    corners = np.float64([[[0, 0], [0, bottom], [right, bottom], [right, 0]]])
    return cv2.perspectiveTransform(corners, H)[0]


def planar_scene(seed, hardness=0.5):
    """A template, a scene that shows it tilted and partly hidden, and its true corners."""
    rng = np.random.default_rng(seed)
    template, scene = texture(rng, TEMPLATE_SIZE), texture(rng)
    H = view(rng, tilt=0.9 * hardness, scale=rng.uniform(0.4, 0.9))
    corners = corners_of(H)
    mask = cv2.warpPerspective(np.full(template.shape[:2], 255, np.uint8), H, SCENE_SIZE)
    shown = cv2.warpPerspective(template, H, SCENE_SIZE, flags=cv2.INTER_AREA)
    scene[mask > 0] = shown[mask > 0]
    left, right = np.clip(corners[:, 0], 0, SCENE_SIZE[0]).min(), corners[:, 0].max()
    hidden = slice(int(left), int(left + rng.uniform(0, 0.5 * hardness) * max(right - left, 0)))
    scene[:, hidden] = texture(rng)[:, hidden]
    scene = np.clip(scene * rng.uniform(0.7, 1.2) + rng.uniform(-15, 15), 0, 255).astype(np.uint8)
    blur, noise = rng.uniform(0, 1.0) * hardness, rng.uniform(2, 7)
    return (
        photographed(rng, template, noise=2, quality=95),
        photographed(rng, scene, blur=blur, noise=noise, quality=int(rng.integers(65, 95))),
        corners,
    )


def other_scene(seed):
    """A scene that shows nothing of any template."""
    rng = np.random.default_rng([seed, 1])
    return photographed(rng, texture(rng), blur=0.4, noise=4, quality=80)
