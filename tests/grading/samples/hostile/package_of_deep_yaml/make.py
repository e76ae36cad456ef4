import build

NODE = '<launch><node pkg="unit4" type="exercise4_2_{}.py" name="a"><rosparam>{}</rosparam></node></launch>'


def make(folder):
    build.hand_in_node("#!/usr/bin/env python3\nimport rospy\nrospy.init_node('n')\n", folder)
    launch = folder / "unit4" / "launch"
    launch.mkdir()
    (launch / "exercise4_2_1.launch").write_text(NODE.format(1, "[" * 3000))
    (launch / "exercise4_2_2.launch").write_text(NODE.format(2, "{a: 2001-02-30, b: " + "[" * 20 + "]" * 20 + "}"))
