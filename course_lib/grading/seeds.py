"""Numbers from the instructor's secret: the same for every student, unknown to all of them."""

from __future__ import annotations

import hashlib


class Seeds:
    """Makes seeds for held-out inputs.

    Parameters
    ----------
    secret : bytes
        The instructor's secret, at least 16 bytes.

    Raises
    ------
    ValueError
        When the secret is too short to be one.
    """

    def __init__(self, secret: bytes) -> None:
        if len(secret) < 16:
            raise ValueError("the secret seed needs at least 16 bytes")
        self._secret = secret

    def __call__(self, *names: object) -> int:
        """Give the 32-bit seed of a name; the same secret and name give the same seed."""
        name = "\x1f".join(map(str, names)).encode()
        key = hashlib.blake2b(self._secret, digest_size=32).digest()
        return int.from_bytes(hashlib.blake2b(name, key=key, digest_size=4).digest(), "little")
