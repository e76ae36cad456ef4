import nbformat
from build import hand_in_node

FORGE = """

from course_lib.grading import wire

def encode(value, original=wire.encode):
    tree, buffers = original(value)
    if isinstance(value, dict) and "topics" in value:
        for key, each in tree["v"]:
            if key == "files":
                each["v"] = [["picture.png", 10**11], ["other.png", 2**62]]
    return tree, buffers

wire.encode = encode
"""
NODE = "import rospy\nrospy.init_node('n')\n"

def make(folder):
    hand_in_node(NODE, folder)
    path = folder / "exercise_4_2.ipynb"
    made = nbformat.read(path, as_version=4)
    made.cells.append(nbformat.v4.new_code_cell(FORGE))
    nbformat.write(made, path)
