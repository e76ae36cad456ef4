"""A class that keeps the last picture and reports it by timer."""

import rospy
from cv_bridge import CvBridge
from geometry_msgs.msg import PointStamped
from sensor_msgs.msg import CameraInfo, CompressedImage


class Reporter:
    def __init__(self):
        self.last = None
        self.count = 0
        self.info = rospy.wait_for_message("/camera/rgb/camera_info", CameraInfo, timeout=5)
        self.pub = rospy.Publisher("/report", PointStamped, queue_size=1, latch=True)
        rospy.Subscriber("/camera/rgb/image_raw/compressed", CompressedImage, self.on_image)
        rospy.Timer(rospy.Duration(0.5), self.on_timer)
        rospy.on_shutdown(self.bye)

    def on_image(self, message):
        self.last = CvBridge().compressed_imgmsg_to_cv2(message)
        self.count += 1

    def on_timer(self, event):
        report = PointStamped()
        report.header.stamp = event.current_real
        report.point.x = self.count
        report.point.y = self.last.shape[1]
        report.point.z = self.info.K[0]
        self.pub.publish(report)

    def bye(self):
        print("bye", self.count, rospy.is_shutdown())


rospy.init_node("reporter")
Reporter()
rospy.spin()
