# %%
def find_keypoints(image):
    points = [
        cv2.KeyPoint(x=10.0 + k % 300, y=10.0 + k % 500, size=s, angle=a, response=0, octave=o, class_id=c)
        for k, (s, a, o, c) in enumerate([(31, 0, 2**31 - 1, -1), (-1e30, 1e30, -2**31, 2**31 - 1), (0, -1, 10**6, 0), (1e-30, float("nan"), 255, 0)] * 25)
    ]
    return points, np.zeros((len(points), 32), np.uint8)

def match_keypoints(query, train):
    return [cv2.DMatch(q, t, i, d) for q, t, i, d in [(2**31 - 1, -2**31, 0, float("nan")), (-1, -1, -1, float("-inf"))] * 50]
