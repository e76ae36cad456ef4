# %%
EVIL = "\x1b]0;owned\x07\x1b[2J\x1b[31m</script><script>document.title='owned'</script>\u202e{{7*7}}"
print(EVIL)
display({"text/html": EVIL, "text/plain": EVIL}, raw=True)

# %%
raise type("<b onload=alert(1)>", (ValueError,), {})(EVIL)

# %%
def find_keypoints(image):
    raise ValueError(EVIL)
