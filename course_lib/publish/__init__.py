"""Publishing the course: execute the notebooks, check them, export them as a web site.

Two commands, each with ``--help``::

    python -m course_lib.publish.execute    run notebooks and store small, stable outputs
    python -m course_lib.publish.site       export the course as HTML that needs no kernel

Nothing that a student imports depends on this package.
"""
