"""Says what its parameters and names are."""

import rospy
from std_msgs.msg import String

rospy.init_node("params", log_level=rospy.DEBUG)
print("count", repr(rospy.get_param("~match_count", 100)))
print("gain", repr(rospy.get_param("~gain", 1.5)))
print("text", repr(rospy.get_param("~text", "none")))
print("list", repr(rospy.get_param("~list", [])))
print("has", rospy.has_param("~gain"), rospy.has_param("/use_sim_time"))
rospy.set_param("~nested", {"a": 1, "b": {"c": 2}})
print("nested", rospy.get_param("~nested/b/c"), rospy.get_param("~nested"))
print("search", rospy.search_param("match_count"))
print("name", rospy.get_name(), rospy.resolve_name("x"), rospy.resolve_name("~x"))
print("argv", rospy.myargv()[1:])
try:
    rospy.get_param("~missing")
except KeyError as error:
    print("missing", error)
pub = rospy.Publisher("chatter", String, queue_size=1, latch=True)
pub.publish(data="late")
rospy.Subscriber("chatter", String, lambda message: print("heard", message.data))
rospy.sleep(0.1)
rospy.logdebug("a detail")
