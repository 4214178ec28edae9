<!DOCTYPE PickedPoints>
<PickedPoints>
 <DocumentData>
  <DateTime time="12:00:00" date="2026-01-01"/>
  <DataFileName name="bar.stl"/>
 </DocumentData>
 <point x="0" y="0.5" z="1" name="a"/>
 <point x="3" y="0.5" z="1" name="b"/>
</PickedPoints>
