"""Launch files of strangers: read as roslaunch would, and nothing in them is run."""

from __future__ import annotations

import pytest

from course_lib.grading.launch_file import read_launch
from course_lib.grading.launch_xml import LaunchError


def only(text: str, **options: str):
    nodes = read_launch(f"<launch>{text}</launch>".encode(), **options)
    assert len(nodes) == 1
    return nodes[0]


NODE = '<node pkg="unit4" type="a.py" name="a">{}</node>'


def test_params_take_the_arguments_defaults_and_roslaunchs_types():
    node = only(
        '<arg name="count" default="58"/><arg name="file" value="$(find unit4)/w.png"/>'
        + NODE.format(
            '<param name="n" value="$(arg count)"/><param name="file" value="$(arg file)"/>'
            '<param name="ratio" value="0.75"/><param name="show" value="False"/>'
            '<param name="word" type="str" value="12"/><param name="out" value="$(env HOME)/x"/>'
            "<rosparam>{deep: [1, 2]}</rosparam>"
        )
    )
    assert node.params == {
        "n": 58,
        "file": "$(find unit4)/w.png",
        "ratio": 0.75,
        "show": False,
        "word": "12",
        "out": "$(env HOME)/x",
        "deep": [1, 2],
    }


def test_remaps_params_and_namespaces_hold_within_their_group():
    text = (
        '<remap from="image" to="/camera/rgb/image_raw"/><param name="~all" value="1"/>'
        '<param name="a/own" value="2"/><param name="b/other" value="3"/>'
        '<group ns="waterhole"><remap from="out" to="image"/>' + NODE.format("") + "</group>"
        '<node pkg="p" type="b.py" name="b" ns="/else" args="_n:=4 -v in:=out"/>'
    )
    first, second = read_launch(f"<launch>{text}</launch>".encode())
    assert first.remaps == {
        "image": "/camera/rgb/image_raw",
        "out": "image",
        "__ns": "waterhole",
        "__name": "a",
    }
    assert first.params == {"all": 1, "/a/own": 2, "/b/other": 3, "/else/b/all": 1, "/else/b/n": 4}
    assert second.params == {"all": 1, "n": 4, "/waterhole/a/all": 1, "/a/own": 2, "/b/other": 3}
    assert second.remaps == {
        "image": "/camera/rgb/image_raw",
        "in": "out",
        "__ns": "else",
        "__name": "b",
    }


def test_names_and_namespaces_may_be_made_of_arguments():
    text = (
        '<arg name="ns" default="waterhole"/><group ns="$(arg ns)">'
        '<param name="$(arg ns)_n/x" value="1"/>'
        '<node pkg="unit4" type="a.py" name="$(arg ns)_n" ns="$(arg ns)_2"/></group>'
    )
    node = only(text)
    assert node.remaps == {"__ns": "waterhole/waterhole_2", "__name": "waterhole_n"}
    assert node.params == {"/waterhole/waterhole_n/x": 1}


def test_parameters_outside_of_nodes_are_there_for_all():
    text = (
        '<param name="n" value="58"/><group ns="well">'
        '<param name="file" value="$(find unit4)/w.png"/>'
        + NODE.format('<param name="own" value="1"/>')
        + '</group><rosparam>{a: {b: 2}, "/abs": [3]}</rosparam>'
    )
    node = only(text)
    assert node.params == {
        "own": 1,
        "/n": 58,
        "/well/file": "$(find unit4)/w.png",
        "/a/b": 2,
        "/abs": [3],
    }


def test_rosparam_sets_one_parameter_or_a_namespace():
    files = {"config/a.yaml": b"file: $(arg file)\nn: 3\n"}
    inside = (
        '<rosparam param="count">58</rosparam><rosparam ns="deep">{a: 1}</rosparam>'
        '<rosparam file="$(find unit4)/config/a.yaml" subst_value="true"/>'
    )
    node = only('<arg name="file" default="w.png"/>' + NODE.format(inside), files=files)
    assert node.params == {"count": 58, "deep/a": 1, "file": "w.png", "n": 3}
    outside = '<rosparam ns="a" command="load">{n: 4}</rosparam>' + NODE.format("")
    assert only(outside).params == {"n": 4}


def test_folders_in_arguments_are_not_split_at_their_blanks():
    node = only(
        '<arg name="output" default="$(env HOME)/frame.png"/>'
        '<node pkg="unit4" type="a.py" name="a" '
        "args=\"_output:=$(arg output) '_file:=$(find unit4)/a b.png' _n:=3\"/>"
    )
    assert node.params == {
        "output": "$(env HOME)/frame.png",
        "file": "$(find unit4)/a b.png",
        "n": 3,
    }


def test_conditions_decide():
    text = '<arg name="on" default="false"/>' + NODE.replace("<node", '<node {}="$(arg on)"')
    assert read_launch(f"<launch>{text.format('if', '')}</launch>".encode()) == []
    assert only(text.format("unless", "")).type == "a.py"


@pytest.mark.parametrize(
    "value",
    [
        "$(arg missing)",
        "$(env SECRET)",
        "$(eval open('x').read())",
        "$(find other)/x",
        "$(arg required)",
    ],
)
def test_what_is_not_known_here_leaves_out_its_parameter(value):
    node = only('<arg name="required"/>' + NODE.format(f'<param name="p" value="{value}"/>'))
    assert node.params == {}


def test_a_package_of_another_name_is_found_under_it():
    param = NODE.format('<param name="p" value="$(find mine)/x"/>')
    assert only(param, package="mine").params == {"p": "$(find unit4)/x"}


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"<launch>", "not well-formed"),
        (b"<lunch/>", "should begin with <launch>"),
        (b"\xff\xfe<\x00", "UTF-8"),
        (b"<!DOCTYPE launch [<!ENTITY a 'aaa'>]><launch>&a;</launch>", "entities"),
        (
            b'<?xml version="1.0"?>\n<!DOCTYPE l SYSTEM "file:///etc/passwd"><launch/>',
            "ent",
        ),
        (b"<launch>" + b"<group>" * 5000 + b"</group>" * 5000 + b"</launch>", "nested too deeply"),
        (b'<launch><group if="yes"/></launch>', "neither true nor false"),
        (b"<launch>" + b" " * 1_000_000 + b"</launch>", "too large"),
    ],
    ids=["cut", "root", "encoding", "entity", "external", "deep", "condition", "large"],
)
def test_what_is_no_launch_file_is_said(data, said):
    with pytest.raises(LaunchError, match=said):
        read_launch(data)


def test_an_argument_that_repeats_itself_does_not_grow():
    args = (
        '<arg name="a0" default="'
        + "x" * 100
        + '"/>'
        + "".join(f'<arg name="a{n + 1}" default="{f"$(arg a{n})" * 10}"/>' for n in range(9))
    )
    node = only(args + NODE.format('<param name="p" value="$(arg a9)"/>'))
    assert node.params == {}


def test_plain_arguments_are_the_nodes_own():
    node = only(
        '<arg name="n" default="58"/><node pkg="unit4" type="a.py" name="a" '
        'args="$(find unit4)/a.png --count $(arg n) _x:=1"/>'
    )
    assert node.arguments == ("$(find unit4)/a.png", "--count", "58")
    assert node.params == {"x": 1}


def test_files_of_the_package_are_included_and_loaded():
    files = {
        "launch/common/node.xml": b"""<launch><arg name="n"/><arg name="m" default="2"/>
            <node pkg="unit4" type="a.py" name="a"><param name="n" value="$(arg n)"/>
            <param name="m" value="$(arg m)"/>
            <rosparam file="$(dirname)/../../config/a.yaml"/></node></launch>""",
        "config/a.yaml": b"count: 58  # measured\ntopic: /camera/rgb/image_raw\n",
    }
    text = b"""<launch><arg name="m" default="7"/>
        <include file="$(find unit4)/launch/common/node.xml" ns="well">
        <arg name="n" value="5"/></include>
        <include file="$(find elsewhere)/launch/other.launch"/></launch>"""
    (node,) = read_launch(text, files=files)
    assert node.params == {"n": 5, "m": 2, "count": 58, "topic": "/camera/rgb/image_raw"}
    assert node.remaps["__ns"] == "well"
    passing = text.replace(b'ns="well"', b'pass_all_args="true"')
    assert read_launch(passing, files=files)[0].params["m"] == 7


def test_a_file_that_includes_itself_comes_to_an_end():
    again = b'<include file="$(find unit4)/launch/a.launch"/>' * 3
    text = b"<launch>" + again + b"</launch>"
    with pytest.raises(LaunchError, match="nested"):
        read_launch(text, files={"launch/a.launch": text})


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("arg('n') + 2", 60),
        ("find('unit4') + '/' + arg('file') + '.png'", "$(find unit4)/well.png"),
        ("n == 58 and not show", True),
        ("int(n / 2)", 29),
        ("dirname() + '/x'", "$(find unit4)/launch/x"),
    ],
)
def test_eval_is_worked_out(expression, value):
    node = only(
        '<arg name="n" default="58"/><arg name="file" default="well"/>'
        '<arg name="show" default="false"/>'
        + NODE.format(f'<param name="x" value="$(eval {expression})"/>')
    )
    assert node.params == {"x": value}


def test_a_declared_latin_1_is_read():
    text = '<?xml version="1.0" encoding="ISO-8859-1"?><launch><!-- für -->{}</launch>'
    nodes = read_launch(text.format(NODE.format("")).encode("latin-1"))
    assert [node.type for node in nodes] == ["a.py"]


@pytest.mark.parametrize(("kind", "value"), [("int", "many"), ("bool", "yes"), ("float", "0.5")])
def test_a_value_that_roslaunch_refuses_is_said(kind, value):
    with pytest.raises(LaunchError, match=f'the parameter n the type "{kind}".*"{value}" is none'):
        only(NODE.format(f'<param name="n" type="{kind}" value="{value}"/>'))


LAUGHS = "a0: &a0 [1, 1]\n" + "".join(
    f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 10)
)


@pytest.mark.parametrize(
    "yaml",
    [
        LAUGHS,
        "x: &x {y: *x}",
        "x: " + "[" * 5000,
        "x: " + "[" * 50 + "]" * 50,
        "\n".join(f"p{n}: 1" for n in range(2000)),
    ],
    ids=["laughs", "itself", "deep", "nested", "many"],
)
def test_yaml_that_grows_is_refused(yaml):
    with pytest.raises(LaunchError, match=r"rosparam|too many parameters"):
        only(NODE.format("<rosparam>" + yaml.replace("&", "&amp;") + "</rosparam>"))


def test_yaml_of_odd_types_becomes_text():
    text = "day: 2026-11-29\nset: !!set {a, b}\n1: one"
    params = only(NODE.format(f"<rosparam>{text}</rosparam>")).params
    assert params["day"] == "2026-11-29"
    assert params["1"] == "one"


@pytest.mark.parametrize("expression", ["'%1000000000d' % 5", "'a' * 10**9", "9**9**9", "-'a'"])
def test_eval_that_grows_is_not_worked_out(expression):
    assert only(NODE.format(f'<param name="x" value="$(eval {expression})"/>')).params == {}


@pytest.mark.parametrize(
    "text",
    [
        '<include file="$(find unit4)/launch/large.launch"/>' * 3,
        '<rosparam file="$(find unit4)/launch/large.yaml"/>' * 3,
        f"<rosparam>{'a: 1 ' * 8000}</rosparam>",
        NODE.format(f'<param name="a" type="yaml" value="{"[1, 2], " * 8000}"/>'),
    ],
)
def test_what_would_take_long_to_read_is_not_read(text):
    files = {
        "launch/large.launch": b"<launch>" + b'<env name="a" value="1"/>' * 7500 + b"</launch>",
        "launch/large.yaml": b"a: 1\n" * 4000,
    }
    with pytest.raises(LaunchError, match="too large"):
        read_launch(f"<launch>{text}</launch>".encode(), files=files)
