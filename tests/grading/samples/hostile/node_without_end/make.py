from build import hand_in_node

NODE = """
#!/usr/bin/env python3
import signal
for number in range(1, 65):
    try:
        signal.signal(number, signal.SIG_IGN)
    except (OSError, ValueError):
        pass
while True:
    pass
"""


def make(folder):
    hand_in_node(NODE, folder)
