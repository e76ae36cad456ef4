# %%
import json

kernel = get_ipython().kernel
session, iopub, parent = kernel.session, kernel.iopub_socket, kernel.get_parent()
stem, number = parent["header"]["msg_id"].rsplit("_", 1)
for ahead in range(-3, 40):
    forged = {"header": {**parent["header"], "msg_id": f"{stem}_{int(number) + ahead}"}}
    for content in ({"execution_state": "idle"}, {"execution_state": 7}, {}, None, [], "idle"):
        session.send(iopub, "status", content, parent=forged)
    session.send(iopub, "error", {"ename": 1, "evalue": [], "traceback": "x"}, parent=forged)
    session.send(iopub, "stream", {"name": "stdout", "text": None}, parent=forged)
    session.send(iopub, "display_data", {"data": [], "metadata": 0}, parent=forged)
    session.send(iopub, "comm_" + "x" * 1000, {}, parent=forged)
    session.send(iopub, "execute_reply", {"status": "ok"}, parent=forged)
for parts in ([], [b""], [b"<IDS|MSG>"], [b"<IDS|MSG>", b"", b"{", b"}", b"[", b"]"], [b"x"] * 1000):
    iopub.send_multipart(parts or [b"", b""])
for text in ("[" * 20_000, '{"msg_type": 1}', "1" * 10_000, '"\\ud800"', "NaN"):
    parts = [text.encode()] * 4
    iopub.send_multipart([b"<IDS|MSG>", session.sign(parts), *parts])
