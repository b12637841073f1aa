"""Monitoring: from samples, recorded or live, to health.

``monitor.py`` takes samples one by one, ``block_monitor.py`` many at a time, both to the same ledger.
``recording_sessions.py`` says what there is to replay and ``replay.py`` replays it; ``live_loop.py`` watches a robot
that runs, with ``live_tasks.py``, ``look_ahead.py`` and ``clock_steps.py``. ``stored_past.py`` finds the past in a
store. ``task_history.py`` and ``wear_from_recordings.py`` say what recordings tell of tasks and of wear,
``seen_wear.py`` and ``wear_watch.py`` what a ledger tells of wear, ``rate_history.py`` of rates;
``task_evaluation.py`` how a task that the robot told of is evaluated.
"""
