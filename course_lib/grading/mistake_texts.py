"""What a student reads about each mistake; ``{thing}`` is what was looked for."""

from __future__ import annotations

MESSAGES = {
    "none": "Your function returned None, but the {thing} is in this scene. Draw the matches, and "
    "print how many inliers there are. If hardly any matches agree, look at how they are made and "
    "sorted. If many agree and the inliers are few, RANSAC is missing or its threshold is not some "
    "5 pixels, or the points are paired wrongly: queryIdx counts the keypoints of the picture "
    "given to match() first, trainIdx the others. If the inliers are many, your check is too "
    "strict.",
    "absent": "Your function returned an outline, but the {thing} is not in this scene. A "
    "homography can be fitted to any four matches: count the inliers in findHomography's mask, "
    "and return None when only a few agree.",
    "nothing": "Where the {thing} is not in the scene, you return something that only stands for "
    "nothing, such as an empty list, zeros, False or a text. Return None itself.",
    "never": "Your function returns None even where the scene is the {thing}'s own picture, in "
    "which everything matches. Does it end in a return of the corners? What is printed is not "
    "returned. Or is a check the wrong way round: < for >, or the sign of cv2.contourArea(…, "
    "oriented=True), which is below zero for corners in this order?",
    "kind": "Your function must return a NumPy array of four (x, y) corners, shape (4, 2), or "
    "None.",
    "nan": "Your corners hold NaN or infinity: a homography went wrong, perhaps fitted to fewer "
    "than four good matches. Return None in that case.",
    "(4, 1, 2)": "Your corners have OpenCV's shape (4, 1, 2). Reshape them before you return them: "
    "corners.reshape(4, 2).",
    "transposed": "Your corners have shape (2, 4): a row of x and a row of y. Return one row for "
    "each corner, shape (4, 2): corners.T.",
    "flat": "Your corners are a flat list of eight numbers. Reshape them: corners.reshape(4, 2).",
    "homography": "You returned the 3 x 3 homography. Send the template's four corners through it "
    "with cv2.perspectiveTransform, and return those.",
    "box": "You returned four numbers, such as x, y, width, height. Return the four corners, "
    "shape (4, 2): a box cannot say that the {thing} is turned or tilted.",
    "one point": "You returned one point. Return the four corners of the {thing}'s picture, shape "
    "(4, 2), not their middle.",
    "with more": "You returned the corners together with something else. Return the corners alone: "
    "whoever calls the function expects one array, shape (4, 2).",
    "three": "You returned three corners. Four are needed: top left, bottom left, bottom right, "
    "top right of the template.",
    "five": "You returned five corners. Is the first repeated to close the outline? Return four.",
    "matches": "You returned many points. Return the template's four corners in the scene, not "
    "the matched keypoints.",
    "inverse": "Your homography goes the wrong way round, from the scene to the template. "
    "findHomography takes the template's points first, then the scene's. With match(template, "
    "scene), queryIdx belongs to the template's keypoints and trainIdx to the scene's.",
    "order": "Your four corners are at the right places but in the wrong order. The order is that "
    "of [[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]]: top left, bottom left, bottom right, "
    "top right of the template.",
    "xy": "x and y are swapped in your corners. Return (x, y); an array is indexed [y, x], so a "
    "keypoint's pt and a pixel's index are the other way round.",
    "wh": "Width and height are swapped in the outline that you send through the homography, or "
    "they are the scene's. shape is (height, width): h, w = template.shape[:2], and the corners "
    "are [[0, 0], [0, h - 1], [w - 1, h - 1], [w - 1, 0]].",
    "scene outline": "You sent the scene's rectangle through the homography. Send the template's: "
    "h, w come from the template's shape.",
    "template size": "Your outline starts at the right corner, but has the size of another "
    "template. Take h, w from the same picture in which you found the keypoints: was it resized?",
    "scene": "You returned the scene's own rectangle. Send the template's corners through the "
    "homography that you found.",
    "template": "You returned the template's own rectangle. Send it through the homography: "
    "cv2.perspectiveTransform(corners, homography).",
    "upright": "You returned an upright box around the {thing}. Return the four mapped corners "
    "themselves: they show how it is turned and tilted.",
    "unit": "Your corners lie between 0 and 1. Return pixels of the scene.",
    "wrapped": "Your corners wrap round to small numbers: uint8 holds none above 255. Return them "
    "as np.float32.",
    "resized": "Your outline has the right shape, but in a picture of another size. Return corners "
    "in the scene as it was given to your function: did you resize it inside?",
    "resized swapped": "Your outline is that of a scene resized to (height, width). cv2.resize "
    "takes (width, height), and the corners must be those of the scene as it was given.",
    "beside": "Your outline is shifted right by the template's width: that is where drawMatches "
    "draws the scene. Return corners in the scene itself.",
    "shifted": "Your outline has the right shape but is shifted. Did you search a part of the "
    "scene and forget to add where it begins?",
    "flipped": "Your outline is the right one in a scene that is flipped. y points down in a "
    "picture, and the first pixel is at the top left.",
    "depth": "Your corners were not divided by their third coordinate after multiplying by the "
    "homography. cv2.perspectiveTransform does that for you.",
    "folded": "Your outline crosses itself: these matches do not agree on one homography. Check "
    "the outline with cv2.isContourConvex, keep the best matches (sorted by distance, cross-check "
    "or ratio test), and use RANSAC.",
    "within": "Your outline lies inside the {thing}'s: is it a box around the matched points? Send "
    "the template's four corners through the homography, and return those.",
    "collapsed": "Your outline has shrunk to a point: these matches do not agree on one "
    "homography. Keep the best matches (sorted by distance, cross-check or ratio test), use "
    "RANSAC, and return None when too few agree.",
    "near": "Your outline is at the right place, but not exactly. Sort the matches by distance "
    "before you take the best, give findHomography cv2.RANSAC and a threshold of about 5 pixels.",
    "far": "Your outline is far from the {thing}. Look at the matches: are they sorted by distance "
    "and cross-checked, is cv2.RANSAC used, does queryIdx index the keypoints of the first picture "
    "given to match() and trainIdx those of the second?",
}
