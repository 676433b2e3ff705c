"""Reports: plots, films, latency curves, the leaderboard, and the tables of `eyas reproduce`."""
