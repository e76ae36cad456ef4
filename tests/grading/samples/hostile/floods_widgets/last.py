# %%
import ipywidgets
from IPython.display import HTML, Javascript, clear_output, update_display
from comm import create_comm

sliders = [ipywidgets.IntSlider(description="<img src=x onerror=alert(1)>") for _ in range(300)]
for number in range(3000):
    create_comm(target_name="evil", data={"x": "y" * 100})
    display(HTML("<script>document.title = 'owned'</script>"), display_id=str(number))
    update_display(Javascript("alert(1)"), display_id=str(number))
    clear_output()
