"""The service behind the page: design, analysis, monitoring and tasks of one robot, over HTTP and one WebSocket."""
