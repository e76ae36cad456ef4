"""The autograder: it looks at submissions from outside; nothing a student imports knows it."""
