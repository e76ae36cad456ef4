# %%
import numpy as np
import cv2 as cv
from matplotlib import pyplot as plt
MIN_MATCH_COUNT = 10

# %%
def load_images():
    img1 = cv.imread('../images/ROS.png')          # queryImage
    img2 = cv.imread('../images/ROS2.png')         # trainImage
    return cv.resize(img1, (400,600), interpolation=cv.INTER_LINEAR), cv.resize(img2, (600,400), interpolation=cv.INTER_LINEAR)

# %%
sift = cv.SIFT_create()

def find_keypoints(image):
    kp, des = sift.detectAndCompute(cv.cvtColor(image, cv.COLOR_BGR2GRAY), None)
    return kp, des

# %%
FLANN_INDEX_KDTREE = 1

def match_keypoints(query_descriptors, train_descriptors):
    good = []
    if query_descriptors is None or train_descriptors is None or len(query_descriptors) == 0 or len(train_descriptors) < 2:
        return good
    flann = cv.FlannBasedMatcher(dict(algorithm = FLANN_INDEX_KDTREE, trees = 5), dict(checks = 50))
    # store all the good matches as per Lowe's ratio test.
    for m,n in flann.knnMatch(query_descriptors.astype(np.float32), train_descriptors.astype(np.float32), k=2):
        if m.distance < 0.7*n.distance:
            good.append(m)
    good.sort(key=lambda m: m.distance)
    return good

# %%
def locate_mug(mug, scene, match_count=100):
    kp1, des1 = find_keypoints(mug)
    kp2, des2 = find_keypoints(scene)
    good = match_keypoints(des1, des2)[:match_count]
    if len(good)>=MIN_MATCH_COUNT:
        src_pts = np.float32([ kp1[m.queryIdx].pt for m in good ]).reshape(-1,1,2)
        dst_pts = np.float32([ kp2[m.trainIdx].pt for m in good ]).reshape(-1,1,2)
        M, mask = cv.findHomography(src_pts, dst_pts, cv.RANSAC,5.0)
        if M is not None and mask.sum() >= MIN_MATCH_COUNT:
            h,w,d = mug.shape
            pts = np.float32([ [0,0],[0,h-1],[w-1,h-1],[w-1,0] ]).reshape(-1,1,2)
            corners = cv.perspectiveTransform(pts,M).squeeze()
            if cv.isContourConvex(corners) and cv.contourArea(corners, oriented=True)<-400:
                return corners
            print("this is no outline of a mug")
            return None
        else:
            print("too few inliers")
            return None
    else:
        print( "Not enough matches are found - {}/{}".format(len(good), MIN_MATCH_COUNT) )
        return None

# %%
img1, img2 = load_images()
kp1, des1 = find_keypoints(img1)
img=cv.drawKeypoints(img1,kp1,None,flags=cv.DRAW_MATCHES_FLAGS_DRAW_RICH_KEYPOINTS)
plt.imshow(img[:,:,::-1]),plt.show()

# %%
kp2, des2 = find_keypoints(img2)
good = match_keypoints(des1, des2)
draw_params = dict(matchColor = (0,255,0), singlePointColor = None, flags = 2)
img3 = cv.drawMatches(img1,kp1,img2,kp2,good,None,**draw_params)
plt.imshow(img3[:,:,::-1]),plt.show()

# %%
dst = locate_mug(img1, img2)
img4 = cv.polylines(img2.copy(),[np.int32(dst)],True,255,3, cv.LINE_AA)
plt.imshow(img4[:,:,::-1]),plt.show()
