import build

NODE = "# find\n" + "\n" * 900_000 + "import rospy\nrospy.init_node('n')\n"
LAUNCH = '<launch><arg name="a" value="$({})"/><node pkg="unit4" type="a" name="b"/></launch>'


def make(folder):
    build.hand_in_node(NODE, folder)
    launch = folder / "unit4" / "launch"
    launch.mkdir()
    for number in (1, 2):
        (launch / f"exercise4_2_{number}.launch").write_text(LAUNCH.format("a" * 190_000))
