"""Many logs of arms of one kind: scheduled, diagnosed one by one, put into one table, compared as a fleet.

Stands above ``tasks``, whose ``diagnose`` it calls for every log, and below the commands. Needs the extra
``fleet``; nothing of it is imported before :func:`jaxswarm.fleet.extra.require` has been called.
"""
