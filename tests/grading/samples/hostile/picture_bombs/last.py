# %%
import base64, struct, zlib

def png(width, height, rows=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")

bombs = [png(60000, 60000), png(4000, 4000, zlib.compress(bytes(48_004_000))), png(0, 0)]
bombs += [png(2**31 - 1, 1), png(1, 1), b"<svg onload=alert(1)>", b"\xff\xd8\xff\xe0" * 1000, b""]
for size in [(1, 5000), (5000, 1), (1, 1), (3, 15_000_000 // 3)]:
    bombs.append(cv2.imencode(".png", np.zeros((*size, 3), np.uint8))[1].tobytes())
for bomb in bombs:
    encoded = base64.b64encode(bomb).decode()
    display({"image/png": encoded, "image/jpeg": encoded, "image/svg+xml": "<svg/>"}, raw=True)
display({"image/png": {"a": 1}, "image/jpeg": None}, raw=True)
display({"image/png": "%%%", "image/jpeg": "\u00e9"}, raw=True)
show(scene)
