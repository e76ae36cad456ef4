"""Feature matching for robotics: the small library behind the notebooks."""
