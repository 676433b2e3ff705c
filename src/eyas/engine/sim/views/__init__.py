"""What is seen of a simulation: when, by which sensors, and drawn how.

`view.py` joins the rest: the state that is seen, now or late (`delay.py`), what sensors read after
each physics step (`sensor_suite.py`), and pictures (`pictures.py`) of the actors that a camera may
show (`visible_actors.py`) and the lights of signals (`near_lights.py`). Begin with `View`.
"""
