# %%
def find_keypoints(image):
    places = [(float(x), float(y)) for x in range(20, 380, 10) for y in range(20, 380, 10)]
    return [cv2.KeyPoint(x, y, 31.0) for x, y in places], np.zeros((len(places), 32), np.uint8)

# %%
def match_keypoints(query_descriptors, train_descriptors):
    n = min(len(query_descriptors), len(train_descriptors))
    return [cv2.DMatch(i, i, 0.0) for i in range(n)]

# %%
def locate_mug(mug, scene, match_count=100):
    h, w = scene.shape[:2]
    box = [[0.3, 0.2], [0.3, 0.8], [0.7, 0.8], [0.7, 0.2]]
    return np.float32(box) * np.float32([w, h])
