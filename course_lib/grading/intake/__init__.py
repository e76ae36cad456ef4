"""Takes in what students hand in: regular files within limits, notebooks made readable."""
