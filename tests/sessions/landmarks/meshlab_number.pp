<!DOCTYPE PickedPoints>
<PickedPoints>
 <DocumentData>
  <DateTime time="12:00:00" date="2026-01-01"/>
  <DataFileName name="bar.stl"/>
 </DocumentData>
 <point x="0" y="zero" z="0.5" name="foot" active="1"/>
</PickedPoints>
