"""What an editor on Windows saves."""


def make(folder):
    for number in (1, 2):
        path = folder / f"unit4/src/exercise4_2_{number}.py"
        path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
