"""`eyas dataset`: makes data sets from recipes, and joins those that were made in shards."""
