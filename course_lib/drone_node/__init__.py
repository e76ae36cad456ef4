"""The simulated drone as a ROS 1 node: `python -m course_lib.drone_node`.

rospy lives in the system's Python, the simulator in the course's. So there are two processes: this
one flies and draws, and `ros_side.py`, run by the Python that has rospy, publishes what it is sent
and sends back what it hears.
"""
