"""Exercise 4.1 as different people would write it, each without having seen another's."""

STUB = [
    '''def load_images():
    """Return the mug, 400 wide and 600 high, and the scene, 600 wide and 400 high."""
    raise NotImplementedError("read both pictures and resize them")''',
    '''def find_keypoints(image):
    """Return the keypoints and descriptors that ORB finds."""
    raise NotImplementedError("convert to gray, then detectAndCompute")''',
    '''def match_keypoints(query_descriptors, train_descriptors):
    """Return the cross-checked matches, best first."""
    raise NotImplementedError("BFMatcher, then sort")''',
    '''def locate_mug(mug, scene, match_count=100):
    """Return the mug's corners in the scene, or None."""
    raise NotImplementedError("findHomography, then perspectiveTransform")''',
]

SOLUTIONS = {
    "tutorial": [
        """def load_images():
    mug = cv2.imread("../images/ROS.png")
    scene = cv2.imread("../images/ROS2.png")
    mug = cv2.resize(mug, (400, 600))
    scene = cv2.resize(scene, (600, 400))
    return mug, scene""",
        """def find_keypoints(image):
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    orb = cv2.ORB_create(nfeatures=1500)
    # None: no mask
    return orb.detectAndCompute(gray, None)""",
        """def match_keypoints(query_descriptors, train_descriptors):
    bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    matches = bf.match(query_descriptors, train_descriptors)
    return sorted(matches, key=lambda x: x.distance)""",
        """def locate_mug(mug, scene, match_count=100):
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    if des1 is None or des2 is None:
        return None
    good = match_keypoints(des1, des2)[:match_count]
    if len(good) < 10:
        return None
    src = np.float32([kp1[m.queryIdx].pt for m in good]).reshape(-1, 1, 2)
    dst = np.float32([kp2[m.trainIdx].pt for m in good]).reshape(-1, 1, 2)
    M, mask = cv2.findHomography(src, dst, cv2.RANSAC, 5.0)
    if M is None or mask.sum() < 12:
        return None
    h, w = mug.shape[:2]
    pts = np.float32([[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]).reshape(-1, 1, 2)
    return cv2.perspectiveTransform(pts, M).reshape(4, 2)""",
        """mug, scene = load_images()
kp, des = find_keypoints(mug)
plt.figure(figsize=(8, 8))
plt.imshow(cv2.cvtColor(cv2.drawKeypoints(mug, kp, None, color=(0, 255, 0)), cv2.COLOR_BGR2RGB))
plt.show()""",
        """kp2, des2 = find_keypoints(scene)
m = match_keypoints(des, des2)
plt.imshow(cv2.drawMatches(mug, kp, scene, kp2, m[:30], None, flags=2)[:, :, ::-1])
plt.show()""",
        """corners = locate_mug(mug, scene)
out = scene.copy()
cv2.polylines(out, [np.int32(corners)], True, (0, 0, 255), 3)
plt.imshow(cv2.cvtColor(out, cv2.COLOR_BGR2RGB))
plt.show()""",
    ],
    "ratio": [
        """PICTURES = pathlib.Path("..") / "images"

def load_images():
    sizes = {"ROS.png": (400, 600), "ROS2.png": (600, 400)}
    loaded = []
    for name, size in sizes.items():
        picture = cv2.imread(str(PICTURES / name), cv2.IMREAD_COLOR)
        if picture is None:
            raise FileNotFoundError(name)
        loaded.append(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))
    return tuple(loaded)""",
        """sift = cv2.SIFT_create(contrastThreshold=0.03)

def find_keypoints(image):
    detector = cv2.ORB_create(2000, fastThreshold=10)
    keypoints = detector.detect(image)
    keypoints, descriptors = detector.compute(image, keypoints)
    return keypoints, descriptors""",
        """def match_keypoints(query_descriptors, train_descriptors):
    forth = cv2.BFMatcher(cv2.NORM_HAMMING).match(query_descriptors, train_descriptors)
    back = cv2.BFMatcher(cv2.NORM_HAMMING).match(train_descriptors, query_descriptors)
    partner = {b.queryIdx: b.trainIdx for b in back}
    mutual = [f for f in forth if partner.get(f.trainIdx) == f.queryIdx]
    mutual.sort(key=operator.attrgetter("distance"))
    return mutual""",
        """def locate_mug(mug, scene, match_count=100):
    points_mug, desc_mug = sift.detectAndCompute(mug, None)
    points_scene, desc_scene = sift.detectAndCompute(scene, None)
    if desc_scene is None or len(desc_scene) < 2:
        return None
    kept = []
    for first, second in cv2.BFMatcher().knnMatch(desc_mug, desc_scene, k=2):
        if first.distance < 0.75 * second.distance:
            kept.append(first)
    kept = sorted(kept, key=lambda match: match.distance)[:match_count]
    if len(kept) < 8:
        return None
    a = np.array([points_mug[match.queryIdx].pt for match in kept], dtype=np.float32)
    b = np.array([points_scene[match.trainIdx].pt for match in kept], dtype=np.float32)
    homography, inliers = cv2.findHomography(a, b, method=cv2.USAC_MAGSAC, ransacReprojThreshold=3)
    if homography is None or inliers.ravel().sum() < 8:
        return None
    height, width, _ = mug.shape
    frame = np.array([(0, 0), (0, height - 1), (width - 1, height - 1), (width - 1, 0)], float)
    return cv2.perspectiveTransform(frame[None], homography)[0]""",
        """template, shelf = load_images()
found_points, _ = find_keypoints(template)
canvas = cv2.drawKeypoints(template, found_points, outImage=None, flags=4)
display(Image(data=cv2.imencode(".png", canvas)[1].tobytes()))""",
        """where = locate_mug(template, shelf)
picture = shelf.copy()
if where is not None:
    for start, end in zip(where, np.roll(where, -1, axis=0)):
        cv2.line(picture, tuple(map(int, start)), tuple(map(int, end)), (0, 255, 255), 4)
display(Image(data=cv2.imencode(".png", picture)[1].tobytes()))""",
    ],
    "class": [
        '''class MugFinder:
    """Finds the mug."""

    def __init__(self, nfeatures=1000):
        self.orb = cv2.ORB_create(nfeatures)
        self.bf = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)

    def keypoints(self, img):
        if img.ndim == 3:
            img = cv2.cvtColor(img, cv2.COLOR_BGR2GRAY)
        return self.orb.detectAndCompute(img, None)

    def pairs(self, d1, d2):
        if d1 is None or d2 is None:
            return []
        ms = list(self.bf.match(d1, d2))
        ms.sort(key=lambda m: m.distance)
        return ms

    def locate(self, mug, scene, n):
        k1, d1 = self.keypoints(mug)
        k2, d2 = self.keypoints(scene)
        ms = self.pairs(d1, d2)[:n]
        if len(ms) >= 4:
            p1 = np.asarray([k1[m.queryIdx].pt for m in ms], "f4")
            p2 = np.asarray([k2[m.trainIdx].pt for m in ms], "f4")
            H, ok = cv2.findHomography(p1, p2, cv2.LMEDS)
            if H is not None and int(ok.sum()) > 10:
                return self.corners(H, *mug.shape[:2])

    @staticmethod
    def corners(H, rows, cols):
        box = [[0, 0, 1], [0, rows - 1, 1], [cols - 1, rows - 1, 1], [cols - 1, 0, 1]]
        q = np.array(box) @ H.T
        return q[:, :2] / q[:, 2:]''',
        """finder = MugFinder()

def load_images():
    a, b = (cv2.imread(f"../images/{n}.png") for n in ("ROS", "ROS2"))
    return cv2.resize(a, dsize=(400, 600)), cv2.resize(b, dsize=(600, 400))

def find_keypoints(image):
    return finder.keypoints(image)

def match_keypoints(query_descriptors, train_descriptors):
    return finder.pairs(query_descriptors, train_descriptors)

def locate_mug(mug, scene, match_count=100):
    return finder.locate(mug, scene, match_count)""",
        """fig, axes = plt.subplots(1, 3, figsize=(15, 5))
a, b = load_images()
ka, da = finder.keypoints(a)
kb, db = finder.keypoints(b)
axes[0].imshow(cv2.drawKeypoints(a, ka, None)[..., ::-1])
axes[1].imshow(cv2.drawMatches(a, ka, b, kb, finder.pairs(da, db)[:50], None)[..., ::-1])
axes[2].imshow(b[..., ::-1])
axes[2].plot(*finder.locate(a, b, 100)[[0, 1, 2, 3, 0]].T, "r-", lw=3)
for axis in axes:
    axis.axis("off")""",
    ],
    "careful": [
        """def _read(name, width, height):
    path = os.path.join("..", "images", name)
    data = np.fromfile(path, dtype=np.uint8)
    return cv2.resize(cv2.imdecode(data, cv2.IMREAD_COLOR), (width, height))

def load_images():
    return _read("ROS.png", 400, 600), _read("ROS2.png", 600, 400)""",
        """def find_keypoints(image):
    gray = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    clahe = cv2.createCLAHE(clipLimit=2.0, tileGridSize=(8, 8))
    keypoints, descriptors = cv2.ORB_create(3000).detectAndCompute(clahe.apply(gray), None)
    if descriptors is None:
        descriptors = np.empty((0, 32), np.uint8)
    return keypoints, descriptors""",
        """def match_keypoints(query_descriptors, train_descriptors):
    if len(query_descriptors) == 0 or len(train_descriptors) == 0:
        return []
    distances = cv2.batchDistance(
        query_descriptors, train_descriptors, cv2.CV_32S, normType=cv2.NORM_HAMMING, K=1
    )
    nearest = distances[1].ravel()
    table = np.unpackbits(query_descriptors[:, None] ^ train_descriptors[None], axis=2).sum(axis=2)
    result = []
    for i, j in enumerate(table.argmin(axis=1)):
        if table[:, j].argmin() == i:
            result.append(cv2.DMatch(int(i), int(j), float(table[i, j])))
    return sorted(result, key=lambda match: match.distance)""",
        """def is_sane(quad):
    area = cv2.contourArea(quad.astype(np.float32))
    return cv2.isContourConvex(quad.astype(np.float32)) and area > 900

def locate_mug(mug, scene, match_count=100):
    kps_mug, des_mug = find_keypoints(mug)
    kps_scene, des_scene = find_keypoints(scene)
    best = match_keypoints(des_mug, des_scene)[:match_count]
    if len(best) < 15:
        return None
    from_points = cv2.KeyPoint_convert(kps_mug, [m.queryIdx for m in best])
    to_points = cv2.KeyPoint_convert(kps_scene, [m.trainIdx for m in best])
    H, used = cv2.findHomography(from_points, to_points, cv2.RHO, 4)
    if H is None:
        return None
    if np.count_nonzero(used) < 15:
        return None
    height, width = mug.shape[:2]
    outline = np.array([[[0, 0]], [[0, height - 1]], [[width - 1, height - 1]], [[width - 1, 0]]])
    quad = cv2.perspectiveTransform(outline.astype(np.float64), H)
    return quad[:, 0] if is_sane(quad) else None""",
        """def show(picture, title):
    plt.title(title)
    plt.axis("off")
    plt.imshow(picture[:, :, [2, 1, 0]])
    plt.show()

cup, shelf = load_images()
kps_cup, des_cup = find_keypoints(cup)
kps_shelf, des_shelf = find_keypoints(shelf)
show(cv2.drawKeypoints(cup, kps_cup, None, (255, 0, 0)), f"{len(kps_cup)} keypoints")
pairs = match_keypoints(des_cup, des_shelf)
show(cv2.drawMatches(cup, kps_cup, shelf, kps_shelf, pairs[:40], None), "matches")
where = locate_mug(cup, shelf).astype(int)
show(cv2.polylines(shelf.copy(), [where], True, (0, 255, 0), 2), "mug")""",
    ],
    "second tutorial": [
        """# the pictures
def load_images():
    img1 = cv2.resize(cv2.imread("../images/ROS.png"), (400, 600))
    img2 = cv2.resize(cv2.imread("../images/ROS2.png"), (600, 400))
    return img1, img2""",
        """orb = cv2.ORB_create(nfeatures=1000)
def find_keypoints(image):
    g = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    k, d = orb.detectAndCompute(g, None)
    return k, d""",
        """def match_keypoints(query_descriptors, train_descriptors):
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)
    found = list(matcher.match(query_descriptors, train_descriptors))
    found.sort(key=lambda d: d.distance)
    return found""",
        """def locate_mug(mug, scene, match_count=100):
    k1, d1 = find_keypoints(mug)
    k2, d2 = find_keypoints(scene)
    if d2 is None:
        return None
    ms = match_keypoints(d1, d2)
    ms = ms[:match_count]
    good1 = np.float32([k1[i.queryIdx].pt for i in ms])
    good2 = np.float32([k2[i.trainIdx].pt for i in ms])
    if len(ms) < 4:
        return None
    H, status = cv2.findHomography(good1, good2, cv2.RANSAC, 3.0)
    inl = np.sum(status) if status is not None else 0
    if inl < 20:
        print("not found, only", inl, "inliers")
        return None
    hh, ww = mug.shape[0], mug.shape[1]
    c = np.float32([[0, 0], [0, hh - 1], [ww - 1, hh - 1], [ww - 1, 0]])
    c = cv2.perspectiveTransform(c.reshape(-1, 1, 2), H)
    return np.squeeze(c)""",
        """img1, img2 = load_images()
k1, d1 = find_keypoints(img1)
k2, d2 = find_keypoints(img2)
both = cv2.drawKeypoints(img1, k1, None, color=(0, 0, 255), flags=0)
plt.imshow(cv2.cvtColor(both, cv2.COLOR_BGR2RGB)), plt.title("keypoints"), plt.show()""",
        """ms = match_keypoints(d1, d2)
hide = cv2.DrawMatchesFlags_NOT_DRAW_SINGLE_POINTS
lines = cv2.drawMatches(img1, k1, img2, k2, ms[:20], None, flags=hide)
plt.imshow(cv2.cvtColor(lines, cv2.COLOR_BGR2RGB)), plt.title("matches"), plt.show()
box = locate_mug(img1, img2)
img3 = cv2.polylines(img2.copy(), [np.int32(box)], True, (0, 255, 0), 5, cv2.LINE_AA)
plt.imshow(cv2.cvtColor(img3, cv2.COLOR_BGR2RGB)), plt.title("the mug"), plt.show()""",
    ],
}
