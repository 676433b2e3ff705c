"""The gallery: a page of pictures of every map and weather."""
