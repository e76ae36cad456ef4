# %%
session, socket = get_ipython().kernel.session, get_ipython().kernel.iopub_socket
parent = get_ipython().kernel.get_parent()
for _ in range(100_000):
    session.send(socket, "stream", {"name": "stdout", "text": "x"}, parent=parent)
