"""Launch files are read as roslaunch itself does: nodes, other names, parameters, refusals."""

from __future__ import annotations

import json
import subprocess
from typing import Any

import pytest

from course_lib.grading.launch_file import LaunchNode, read_launch
from course_lib.grading.launch_xml import LaunchError
from course_lib.real_ros import system

FILES = {
    "package.xml": "<package format='2'><name>unit4</name><version>1.0.0</version>"
    "<description>d</description><maintainer email='a@b.c'>a</maintainer><license>MIT</license>"
    "</package>",
    "config/p.yaml": "match_count: 58\ndeep: {a: 1, b: [1, 2]}\nn: no\ny: 3\n",
    "launch/inc.launch": '<launch><arg name="n" default="7"/><node pkg="unit4" type="i.py" '
    'name="i"><param name="n" value="$(arg n)"/></node></launch>',
}
NODE = '<node pkg="unit4" type="a.py" name="a">{}</node>'
N58 = '<arg name="n" default="58"/>'
OUTSIDE = (  # beside a node
    '<param name="g" value="1"/>',
    '<param name="~p" value="1"/>',
    '<param name="a/p" value="1"/>',
    '<param name="/a/p" value="1"/>',
    '<param name="x" value="1"/><param name="x" value="2"/>',
    "<rosparam>{x: 1, y: {z: [1, 2]}}</rosparam>",
    "<rosparam>{a: {p: 1}}</rosparam>",
    "<rosparam>{/abs: [3]}</rosparam>",
    '<rosparam command="load" file="$(find unit4)/config/p.yaml" ns="a"/>',
    '<arg name="t" default="/camera/rgb/image_raw"/><remap from="image" to="$(arg t)"/>',
    '<include file="$(find unit4)/launch/inc.launch"/>',
    '<include file="$(find unit4)/launch/inc.launch"><arg name="n" value="9"/></include>',
    '<include file="$(find unit4)/launch/inc.launch" ns="w"><arg name="n" value="9"/></include>',
    '<include file="$(dirname)/inc.launch" pass_all_args="true"/>',
    '<arg name="n" value="3"/><include file="$(dirname)/inc.launch" pass_all_args="true"/>',
    '<arg name="n" value="3"/><include file="$(dirname)/inc.launch"/>',
    '<group ns="b"><remap from="x" to="y"/></group>',
    '<env name="X" value="1"/><machine name="m" address="localhost"/><bogus/>',
    '<node pkg="unit4" type="a.py" name="b" ns="w"><param name="p" value="1"/></node>',
    # refused
    '<node pkg="unit4" type="a.py" name="a"/>',
    '<node pkg="unit4" type="a.py" name="w/b"/>',
    '<arg name="n" default="1"/><arg name="n" default="2"/>',
    '<arg name="n" default="1" value="2"/>',
    '<arg default="1"/>',
    '<include file="$(find unit4)/launch/none.launch"/>',
    '<group if="yes"/>',
    '<rosparam file="$(find unit4)/config/none.yaml"/>',
)
INSIDE = (  # a node
    '<param name="n" value=" 58 "/>',
    '<param name="n" value="1e3"/><param name="m" value="1_000"/>',
    '<param name="/root" value="5"/><param name="~own" value="5"/><param name="sub/x" value="5"/>',
    '<param name="t" type="string" value="a &amp; 1"/><param name="d" type="double" value="1"/>',
    '<param name="e" value=""/><param name="o" value="$(optenv NOT_SET some words)"/>',
    '<param name="y" value="1"/><param name="y" value="2"/>',
    '<rosparam file="$(find unit4)/config/p.yaml"/>',
    '<rosparam command="load" file="$(find unit4)/config/p.yaml" ns="sub"/>',
    '<rosparam param="list">[1, 2, 3]</rosparam>',
    '<rosparam>\nmatch_count: 58\nname: "x"\n</rosparam>',
    '<rosparam subst_value="true">match_count: $(arg n)</rosparam>',
    "<rosparam>match_count: $(arg n)</rosparam>",
    '<param name="n" value="$(arg n)" type="int"/>',
    '<param name="n" value="$(eval n + 2)"/><param name="m" value="$(eval arg(\'n\') * 2)"/>',
    '<param name="n" value="$(eval int(n) % 5)"/><param name="m" value="$(eval max(n, 60))"/>',
    "<param name=\"n\" value=\"$(eval 'few' if n &lt; 60 else 'many')\"/>",
    '<param name="n" value="$(eval 7 // 2 * -1)"/>',
    '<param name="x" value="1" if="$(eval n == 58)"/><param name="y" value="1" unless="true"/>',
    '<remap from="image" to="/camera/rgb/image_raw"/><remap from="~corners" to="/well/corners"/>',
    '<bogus x="1"/><arg name="m" value="2"/>',
    # refused
    '<param name="n"/>',
    '<param value="3"/>',
    '<param name="n" type="int" value="many"/>',
    '<remap from="a"/>',
    "<rosparam>5</rosparam>",
    "<rosparam>{</rosparam>",
    '<param name="n" value="$(nope x)"/>',
    '<param name="n" value="a $(eval 1 + 1)"/>',
)
WHOLE = (
    '<group ns="w"><param name="a/p" value="1"/>' + NODE.format("") + "</group>",
    '<group ns="w"><param name="p" value="1"/>' + NODE.format("") + "</group>",
    '<group ns="w"><param name="~p" value="1"/>' + NODE.format("") + "</group>",
    '<group ns="/w"><group ns="v">'
    + NODE.format('<param name="p" value="x"/>')
    + "</group></group>",
    '<arg name="ns" default="well"/><group ns="$(arg ns)">' + NODE.format("") + "</group>",
    '<arg name="ns" default="well"/><node pkg="unit4" type="a.py" name="a" ns="$(arg ns)"/>',
    '<arg name="on" default="1"/><node if="$(arg on)" pkg="unit4" type="a.py" name="a"/>',
    '<arg name="on" default="no"/><group if="$(eval on == \'no\')">' + NODE.format("") + "</group>",
    '<node pkg="unit4" type="a.py" name="a" output="screen" respawn="true" clear_params="true"/>',
)
TEXTS = [
    *(NODE.format("") + text for text in OUTSIDE),
    *(text + NODE.format("") for text in OUTSIDE),
    *(N58 + NODE.format(text) for text in INSIDE),
    *WHOLE,
]
ASK = """
import json, sys, roslaunch.config
def ask(path):
    try:
        found = roslaunch.config.load_config_default([path], None, verbose=False)
    except Exception as error:
        return str(error)
    nodes = [[n.package, n.type, n.namespace + n.name, dict(n.remap_args)] for n in found.nodes]
    return [nodes, {name: each.value for name, each in found.params.items()}]
print(json.dumps([ask(path) for path in json.load(sys.stdin)]))
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> list[Any]:
    package = tmp_path_factory.mktemp("ros") / "unit4"
    paths = [package / "launch" / f"t{number}.launch" for number in range(len(TEXTS))]
    for name, content in FILES.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(content)
    for path, text in zip(paths, TEXTS, strict=True):
        path.write_text(f"<launch>{text}</launch>")
    done = subprocess.run(
        [system.PYTHON, "-c", ASK],
        input=json.dumps([str(path) for path in paths]),
        env=system.environment(package.parent, 1, [package.parent]),
        capture_output=True,
        text=True,
        check=True,
    )
    return [
        each
        if isinstance(each, str)
        else json.loads(json.dumps(each).replace(str(package), "HERE"))
        for each in json.loads(done.stdout.splitlines()[-1])
    ]


def ours(text: str) -> list[LaunchNode] | str:
    try:
        files = {name: content.encode() for name, content in FILES.items()}
        return read_launch(f"<launch>{text}</launch>".encode(), files=files)
    except LaunchError as error:
        return str(error)


def full_name(node: LaunchNode) -> str:
    return "/" + f"{node.remaps.get('__ns', '')}/{node.name}".lstrip("/")


@pytest.mark.parametrize("number", range(len(TEXTS)), ids=TEXTS)
def test_launch_file_is_read_as_roslaunch_does(number: int, theirs: list[Any]) -> None:
    found, expected = ours(TEXTS[number]), theirs[number]
    if isinstance(expected, str) or isinstance(found, str):
        assert isinstance(expected, str), found
        assert isinstance(found, str), expected
        return
    nodes, params = expected
    remaps = [
        {left: right for left, right in node.remaps.items() if not left.startswith("__")}
        for node in found
    ]
    assert [
        [node.package, node.type, full_name(node), others]
        for node, others in zip(found, remaps, strict=True)
    ] == nodes
    expected = {name: params[name] for name in params if name not in {"/rosversion", "/rosdistro"}}
    for node in found:
        own = full_name(node)
        seen = {
            name if name.startswith("/") else f"{own}/{name}": value
            for name, value in node.params.items()
        }
        assert seen == expected
