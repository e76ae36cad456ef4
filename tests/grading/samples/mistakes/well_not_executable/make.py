"""What a zip that is unpacked with the mouse leaves of permissions."""


def make(folder):
    for number in (1, 2):
        (folder / f"unit4/src/exercise4_2_{number}.py").chmod(0o644)
