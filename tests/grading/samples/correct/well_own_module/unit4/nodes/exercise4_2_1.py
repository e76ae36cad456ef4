#!/usr/bin/env python3
import rospy, cv2, cv_bridge
import sensor_msgs.msg
zähler = 0
def rückruf(nachricht):
    global zähler
    zähler += 1
    if zähler == rospy.get_param("~nummer", 3):
        bild = cv_bridge.CvBridge().imgmsg_to_cv2(nachricht, "bgr8")
        datei = rospy.get_param("~output", "bild.png")
        rospy.loginfo("%s gespeichert: %s", datei, cv2.imwrite(datei, bild))
        rospy.signal_shutdown("fertig")
rospy.init_node("foto")
rospy.Subscriber("/camera/rgb/image_raw", sensor_msgs.msg.Image, rückruf)
rospy.spin()
