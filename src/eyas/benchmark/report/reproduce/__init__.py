"""`eyas reproduce`: flies the tables of the documents again, and tells whether they are equal."""
